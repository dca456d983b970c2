# Where a drape onto a ball by contact springs explodes, and the step that is proved for any contact.
# Needs: type ('svg' or 'png'), output_file, data (path without suffix), free_limit [s], duration [s].
# Reads data.csv (k_c,h,ratio,diverged) and data_proved.csv (k_c,h_proved,ratio).

if (type eq 'svg') {
    set terminal svg size 900,600 font 'DejaVu Sans,12' background '#ffffff'
} else {
    set terminal pngcairo size 1080,720 font 'DejaVu Sans,11' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

set title sprintf("A drape onto a ball by contact springs explodes at the step that is stable without\n{/*0.8 symplectic Euler, %g s; its limit without contact is %.3g ms}", \
                  duration, 1000 * free_limit) font ',14'
set border 3
set tics out nomirror
set logscale xy
set xrange [7e1:1.5e7]
set yrange [3e-3:1.4]
set format x '10^{%T}'
set xlabel 'stiffness of contact k_c [N/m]'
set ylabel 'h / limit without contact'
set grid lw 0.5 lc rgb '#dddddd'
set key bottom left Left reverse samplen 2 spacing 1.2 box lc rgb '#dddddd' opaque
set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead lw 1.5 dt 2 lc rgb '#555555'
plot data . '.csv' every ::1 using 1:($4 == 1 ? $3 : NaN) with points pt 2 ps 1.0 lw 2 lc rgb '#d55e00' \
         title 'explodes', \
     '' every ::1 using 1:($4 == 0 ? $3 : NaN) with points pt 7 ps 0.9 lc rgb '#0072b2' title 'does not', \
     data . '_proved.csv' every ::1 using 1:3 with lines lw 2.5 lc rgb '#222222' \
         title 'proved for any contact'
