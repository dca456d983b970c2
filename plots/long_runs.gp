# Long runs: energy drift without damping, and the phase of a slow mode while fast ones are damped.
# Needs: type ('svg' or 'png'), output_file, energies, phases, k0, h, series and name_i for each series i.
# Reads energies: blocks of time,drift,diverges_next; phases: blocks of step_times_sqrt_k0,degrees_a_period.

if (type eq 'svg') {
    set terminal svg size 1100,560 font 'DejaVu Sans,12' background '#ffffff'
} else {
    set terminal pngcairo size 1320,672 font 'DejaVu Sans,12' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

array colour[7] = ['#d55e00', '#cc79a7', '#0072b2', '#000000', '#009e73', '#e69f00', '#56b4e9']
array dash[7] = [1, 1, 1, 1, 1, 2, 2]
array point[7] = [5, 9, 7, 2, 13, 4, 6]
name(i) = value(sprintf('name_%d', i))

set multiplot
set logscale xy
set format '10^{%T}'
set border 3
set tics out nomirror
set grid lw 0.5 lc rgb '#e4e4e4'
set bmargin at screen 0.27
set tmargin at screen 0.9

set lmargin at screen 0.075
set rmargin at screen 0.485
set title sprintf('Undamped net, h = 1/√k₀ = %.3g s; × diverges', h) font ',12'
set xlabel 'time   (s)'
set ylabel 'largest |E − E_0| so far, of the kinetic energy at t = 0'
set yrange [1e-8:1e6]
set key at screen 0.5, 0.15 center top horizontal maxrows 2 Left reverse samplen 2.5 spacing 1.3 font ',10'
plot for [i = 1:series] energies index i - 1 using 1:2 with lines lw 2 dt dash[i] lc rgb colour[i] notitle, \
     for [i = 1:series] energies index i - 1 using ($3 == 1 ? $1 : NaN):($2 > 1e6 ? 5e5 : $2) with points pt 2 ps 1.4 lw 2 lc rgb colour[i] notitle, \
     for [i = 1:series] keyentry with linespoints pt point[i] ps 1 lw 2 dt dash[i] lc rgb colour[i] title name(i)

set lmargin at screen 0.575
set rmargin at screen 0.985
set title 'The slowest mode of a chain, its fastest mode damped critically' font ',12'
set xlabel 'step times √k₀'
set ylabel 'error of the phase   (degrees a period)'
set yrange [1e-10:*]
unset key
plot for [i = 1:series] phases index i - 1 using 1:2 with linespoints pt point[i] ps 1 lw 2 dt dash[i] lc rgb colour[i] notitle
unset multiplot
