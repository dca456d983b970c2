# Implicit Euler against its step: conjugate gradient iterations, predicted and measured, and CPU time.
# Needs: type ('svg' or 'png'), output_file, data, heading, footer, rounds, series, and for each series i name_i.
# Reads data: blocks of x,median,least,most,relative,products,iterations,predicted.

if (type eq 'svg') {
    set terminal svg size 1150,640 font 'DejaVu Sans,13' background '#ffffff'
} else {
    set terminal pngcairo size 1440,800 font 'DejaVu Sans,12' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

array colour[3] = ['#000000', '#d55e00', '#0072b2']
array point[3] = [5, 7, 9]
name(i) = value(sprintf('name_%d', i))

set multiplot title heading . ' (Fig. 7 of the paper)' font ',15' offset 0, -0.3
set label 1 footer at screen 0.01, 0.018 left font ',8' textcolor rgb '#555555'
set label 2 sprintf('medians of %d interleaved rounds, bars from the fastest to the slowest', rounds) \
    at screen 0.01, 0.045 left font ',8' textcolor rgb '#555555'

set logscale xy
stats data using 1 nooutput
set xrange [STATS_min / 1.2:STATS_max * 1.2]
set xlabel 'step h   (s)'
set border 3
set tics out nomirror
set grid lw 0.5 lc rgb '#dddddd'
set xtics (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02)
set bmargin at screen 0.28
set tmargin at screen 0.9

set lmargin at screen 0.075
set rmargin at screen 0.49
set ylabel 'CG iterations of the whole run'
set offsets graph 0, graph 0, graph 0.05, graph 0.05
set autoscale yfix
set ytics (50, 100, 200, 500, 1000, 2000, 5000, 10000, 20000, 50000)
set key at screen 0.28, 0.185 center top vertical maxrows 3 Left reverse samplen 2.5 spacing 1.3 font ',11'
plot for [i = 1:series] data index i - 1 using 1:7 with linespoints pt point[i] ps 1 lw 2 lc rgb colour[i] \
         title name(i) . ', measured', \
     for [i = 1:series - 1] data index i - 1 using 1:8 with lines lw 2 dt (8, 5) lc rgb colour[i] \
         title name(i) . ', predicted: ½√σ ln(2/ε)'

unset label 1
unset label 2
set lmargin at screen 0.57
set rmargin at screen 0.985
set ylabel 'CPU time   (s)'
set ytics (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5)
set key at screen 0.78, 0.185 center top vertical maxrows 3
plot for [i = 1:series] data index i - 1 using 1:2 with lines lw 1.3 lc rgb colour[i] notitle, \
     for [i = 1:series] data index i - 1 using 1:2:3:4 with yerrorbars pt point[i] ps 1 lw 1.5 lc rgb colour[i] \
         title name(i)
unset multiplot
