# A draping cloth as a lit surface with its mesh, axes to one scale.
# Needs: type ('svg' or 'png'), output_file, data (x,z,y by rows), side, time_0.

if (type eq 'svg') {
    set terminal svg size 800,660 font 'DejaVu Sans,14' background '#ffffff'
} else {
    set terminal pngcairo size 1000,825 font 'DejaVu Sans,13' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

set title sprintf('Draping cloth, %d×%d particles, held in its middle, %.2f s after it was let go (Fig. 4 of the paper)', side, side, time_0)
set view 62, 33, 1.2
set view equal xyz
set xyplane relative 0.05
set xlabel 'x   (m)' offset 0, -0.5
set ylabel 'z   (m)' offset 1.5, -0.5
set zlabel 'y   (m)' rotate
set border 4095 lw 0.4 lc rgb '#aaaaaa'
set tics 0.2 textcolor rgb '#333333'
set palette defined (0 '#8fbbdc', 1 '#8fbbdc')
unset colorbox
set cbrange [-10:10]
unset key
set pm3d depthorder border lc rgb '#0a3d62' lw 0.6 lighting primary 0.45 specular 0.15
splot data using 1:2:3 with pm3d
