# CPU time of the methods against n or √k0, and the same relative to the first series.
# Needs: type ('svg' or 'png'), output_file, data, heading, footer, rounds, number, symbol, xlabel, series,
# and for each series i name_i, exponent_i (text), a_i and b_i of the fit y = a x^b.
# Reads data: blocks of x,median,least,most,relative,...

if (type eq 'svg') {
    set terminal svg size 1150,640 font 'DejaVu Sans,13' background '#ffffff'
} else {
    set terminal pngcairo size 1440,800 font 'DejaVu Sans,12' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

# Okabe and Ito's colours, and a point type each: told apart with any colour vision, and in grey.
array colour[8] = ['#000000', '#7f7f7f', '#d55e00', '#e69f00', '#0072b2', '#009e73', '#cc79a7', '#56b4e9']
array point[8] = [5, 4, 7, 6, 9, 11, 13, 8]
label_of(i) = value(sprintf('name_%d', i)) . ':  ' . symbol . '^{ ' . value(sprintf('exponent_%d', i)) . '}'
fit(i, x) = value(sprintf('a_%d', i)) * x**value(sprintf('b_%d', i))

set multiplot title heading . ' (Fig. ' . number . ' of the paper)' font ',15' offset 0, -0.3
set label 1 footer at screen 0.01, 0.018 left font ',8' textcolor rgb '#555555'
set label 2 sprintf('medians of %d interleaved rounds, bars from the fastest to the slowest; exponents with 95 %% confidence', rounds) \
    at screen 0.01, 0.045 left font ',8' textcolor rgb '#555555'

stats data using 1 nooutput
set xrange [STATS_min / 1.15:STATS_max * 1.15]
set logscale xy
set xlabel xlabel
set border 3
set tics out nomirror
set format x '10^{%L}'
set format y '10^{%L}'
set grid lw 0.5 lc rgb '#dddddd'
set bmargin at screen 0.17
set tmargin at screen 0.9

set lmargin at screen 0.065
set rmargin at screen 0.44
set ylabel 'CPU time   (s)'
unset key
plot for [i = 1:series] fit(i, x) with lines lw 1.3 lc rgb colour[i] notitle, \
     for [i = 1:series] data index i - 1 using 1:2:3:4 with yerrorbars pt point[i] ps 0.9 lw 1.2 lc rgb colour[i]

unset label 1
unset label 2
set lmargin at screen 0.52
set rmargin at screen 0.77
set ylabel 'CPU time relative to ' . name_1
set format y '%g'
set ytics (0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5, 7, 10, 20, 30, 50, 100)
set offsets graph 0, graph 0, graph 0.05, graph 0.05
set autoscale yfix
set key at screen 0.785, 0.9 left top Left reverse vertical samplen 1.5 spacing 1.6 font ',11'
plot for [i = 1:series] data index i - 1 using 1:5 with linespoints pt point[i] ps 0.9 lw 1.3 lc rgb colour[i] \
     title label_of(i)
unset multiplot
