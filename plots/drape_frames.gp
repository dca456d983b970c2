# Frames of a draping cloth, side by side and to one scale.
# Needs: type ('svg' or 'png'), output_file, data (x,z,y by rows, two blank lines between frames), side, frames,
# time_0, time_1, ...

if (type eq 'svg') {
    set terminal svg size 1200,660 font 'DejaVu Sans,14' background '#ffffff'
} else {
    set terminal pngcairo size 1500,825 font 'DejaVu Sans,13' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

stats data using 1 nooutput name 'X'
stats data using 2 nooutput name 'Z'
stats data using 3 nooutput name 'Y'
set xrange [X_min:X_max]
set yrange [Z_min:Z_max]
set zrange [Y_min:Y_max]
set view 62, 33, 1
set view equal xyz
set xyplane 0
unset border
unset tics
set palette defined (0 '#8fbbdc', 1 '#8fbbdc')
unset colorbox
set cbrange [-10:10]
unset key
set pm3d depthorder border lc rgb '#0a3d62' lw 0.3 lighting primary 0.45 specular 0.15
set multiplot layout 2, (frames + 1) / 2 margins 0.01, 0.99, 0.0, 0.88 spacing 0.01, 0.03 \
    title sprintf('A cloth of %d×%d particles, held in its middle', side, side) font ',17'
do for [i = 0:frames - 1] {
    set title sprintf('%.2f s', value(sprintf('time_%d', i))) offset 0, 1.2
    splot data index i using 1:2:3 with pm3d
}
unset multiplot
