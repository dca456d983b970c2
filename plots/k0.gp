# k0 along drapes, and the products that finding it again takes.
# Needs: type ('svg' or 'png'), output_file, data, drapes, name_1, name_2, ...
# Reads data: blocks of time,k0,ratio,stretch, then products,error,converged of the power method cold and warm and of
# ARPACK cold and warm.

if (type eq 'svg') {
    set terminal svg size 1150,640 font 'DejaVu Sans,13' background '#ffffff'
} else {
    set terminal pngcairo size 1440,800 font 'DejaVu Sans,12' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

array colour[5] = ['#000000', '#e69f00', '#d55e00', '#0072b2', '#009e73']
array dash[5] = [1, 1, 1, 2, 2]

set multiplot title 'The stiffness of draping cloths' font ',15' offset 0, -0.3
set xlabel 'time   (s)'
set border 3
set tics out nomirror
set grid lw 0.5 lc rgb '#dddddd'
set bmargin at screen 0.33
set tmargin at screen 0.9

set lmargin at screen 0.07
set rmargin at screen 0.48
set ylabel 'k₀(t) / k₀(0)'
set yrange [0.9:*]
set arrow 1 from graph 0, first 1.5 to graph 1, first 1.5 nohead lw 1.5 dt (8, 5) lc rgb '#7f7f7f'
set label 1 'safety factor 1.5' at graph 0.98, first 1.5 right offset 0, 0.6 textcolor rgb '#555555'
set key at screen 0.27, 0.22 center top vertical maxrows 5 Left reverse samplen 2.5 spacing 1.3 font ',11'
plot for [i = 1:drapes] data index i - 1 using 1:3 with lines lw 2.5 dt dash[i] lc rgb colour[i] \
     title value(sprintf('name_%d', i))

unset arrow 1
unset label 1
set lmargin at screen 0.57
set rmargin at screen 0.985
set ylabel 'products to a residual of 10^{-3} k₀, second drape'
set yrange [0.8:*]
set logscale y
set key at screen 0.78, 0.22 center top vertical maxrows 2
plot data index 1 using 1:5 with linespoints pt 4 ps 0.7 lw 1.5 lc rgb '#0072b2' title 'power method, random start', \
     '' index 1 using 1:8 with linespoints pt 5 ps 0.7 lw 1.5 lc rgb '#56b4e9' title 'power method, from the last vector', \
     '' index 1 using 1:11 with linespoints pt 6 ps 0.7 lw 1.5 lc rgb '#7a1f00' title 'ARPACK, random start', \
     '' index 1 using 1:14 with linespoints pt 7 ps 0.7 lw 1.5 lc rgb '#d55e00' title 'ARPACK, from the last vector'
unset multiplot
