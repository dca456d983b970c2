# k0 along a motion.
# Needs: $k0 (time,ratio to that of the start), safety. Draws an SVG to stdout, in the colours that a report's page knows.

set terminal svg size 920,380 font 'sans-serif,15' dynamic
set datafile separator ','
set encoding utf8

stats $k0 using 2 name 'ratio' nooutput
top = ratio_max > safety ? ratio_max : safety
low = ratio_min < 1 ? ratio_min : 1
set yrange [low - 0.08 * (top - low):top + 0.12 * (top - low)]
set border 3
set tics out nomirror
set grid lw 0.7 lc rgb '#e4e4e4'
set xlabel 'time   (s)'
set ylabel 'k₀(t) / k₀(0)'
unset key
set arrow 1 from graph 0, first safety to graph 1, first safety nohead lw 1.5 dt (8, 5) lc rgb '#555555'
set label 1 sprintf('safety factor %g', safety) at graph 0.99, first safety right offset 0, 0.7
plot $k0 using 1:2 with linespoints pt 7 ps 0.6 lw 2.5 lc rgb '#d55e00'
