# The share of runs between walls that diverge, over the step relative to the limit without walls.
# Needs: type ('svg' or 'png'), output_file, data (structure,method,model,part,runs,diverged,...), runs.

if (type eq 'svg') {
    set terminal svg size 1150,470 font 'DejaVu Sans,12' background '#ffffff'
} else {
    set terminal pngcairo size 1440,590 font 'DejaVu Sans,11.5' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

methods = 'symplectic-euler velocity-verlet rk4 nystrom4'
array colour[4] = ['#0072b2', '#d55e00', '#009e73', '#cc79a7']
structures = 'chains nets cloth'

set multiplot layout 1, 3 margins 0.06, 0.985, 0.13, 0.78 spacing 0.035 \
    title sprintf("Runs between walls that diverge, of %d each\n{/*0.8 solid: impulses that let a mass land; dashed: inelastic impulses, which take all velocity into the wall}", runs) font ',15'
set border 3
set tics out nomirror
set xrange [0.48:1.02]
set yrange [-0.03:*]
set xlabel 'h / limit without walls'
set grid lw 0.5 lc rgb '#dddddd'
set key top left samplen 2
do for [s in structures] {
    set title s font ',13'
    if (s eq 'chains') { set ylabel 'share that diverges' } else { unset ylabel; unset key }
    plot for [m = 1:4] data using (strcol(1) eq s && strcol(2) eq word(methods, m) && strcol(3) eq 'impulses' ? $4 : NaN):($6 / $5) \
             with linespoints pt 7 ps 0.7 lw 2 lc rgb colour[m] title word(methods, m), \
         for [m = 1:4] data using (strcol(1) eq s && strcol(2) eq word(methods, m) && strcol(3) eq 'inelastic' ? $4 : NaN):($6 / $5) \
             with linespoints pt 6 ps 0.7 lw 2 dt 2 lc rgb colour[m] notitle
}
unset multiplot
