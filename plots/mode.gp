# The stiffest mode of a scene: each vertex, coloured by its share, and where the mode moves it. By itself:
#     build/springstab limits skirt.obj --mode mode.csv
#     gnuplot -e "type='png'; output_file='mode.png'; data='mode.csv'" plots/mode.gp
# Needs: type ('svg' or 'png'), output_file, data (vertex,x,y,z,ux,uy,uz,share as limits --mode writes it).

if (type eq 'svg') {
    set terminal svg size 900,700 font 'DejaVu Sans,13' background '#ffffff'
} else {
    set terminal pngcairo size 1125,875 font 'DejaVu Sans,12' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

stats data skip 1 using 2 nooutput name 'X'
stats data skip 1 using 3 nooutput name 'Y'
stats data skip 1 using 4 nooutput name 'Z'
stats data skip 1 using (sqrt($5**2 + $6**2 + $7**2)) nooutput name 'U'
larger(a, b) = a > b ? a : b
extent = larger(larger(X_max - X_min, Y_max - Y_min), Z_max - Z_min)
scale = 0.15 * extent / U_max
margin = 0.1 * extent
set xrange [X_min - margin:X_max + margin]
set yrange [Z_min - margin:Z_max + margin]
set zrange [Y_min - margin:Y_max + margin]
set view equal xyz
set view 60, 35, 1.5
set xyplane at Y_min - margin
set xlabel 'x [m]'
set ylabel 'z [m]' offset 1, 0
set zlabel 'y [m]' rotate
set palette defined (0 '#cccccc', 0.02 '#56b4e9', 0.3 '#e69f00', 1 '#d55e00')
set colorbox horizontal user origin 0.3, 0.9 size 0.4, 0.025
set cblabel 'share of the mode'
unset key
splot data skip 1 using 2:4:3:8 with points pt 7 ps 1 lc palette, \
    data skip 1 using 2:4:3:(scale * $5):(scale * $7):(scale * $6) with vectors head filled lc rgb '#0a3d62' lw 1.6
