# Error against run time of one scene: a line a method.
# Needs: $runs (blocks of seconds,error), series and for each name_i; x_min, x_max. Draws an SVG to stdout, in the
# colours that a report's page knows.

rows = (series + 2) / 3
height = 440. + 24 * rows
set terminal svg size 920,height font 'sans-serif,15' dynamic
set datafile separator ','
set encoding utf8

array colour[10] = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9, 0x882255, 0x332288, 0x661100, 0x555555]
array shape[10] = [7, 5, 9, 13, 11, 6, 4, 8, 12, 10]
nth(i) = (i - 1) % 10 + 1
dash(i) = i > 10 ? 2 : 1

set logscale xy
set format x '10^{%T}'
set format y '10^{%T}'
set xrange [x_min:x_max]
# Less than a decade has at most one power of ten to name.
if (x_max < 100 * x_min) {
    set xtics ()
    set format x '%g'
    do for [power = floor(log10(x_min)):floor(log10(x_max))] {
        set xtics add (10**power, 2 * 10**power, 5 * 10**power)
    }
}
set border 3
set tics out nomirror
set grid lw 0.7 lc rgb '#e4e4e4'
set xlabel 'CPU time   (s)'
set ylabel 'error of the trajectory   (relative)'
set key at screen 0.53, 0.01 center bottom vertical maxrows rows Left reverse samplen 2 spacing 1.25 noenhanced font ',13'
set bmargin at screen (80. + 24 * rows) / height
plot for [i = 1:series] $runs index i - 1 using 1:2 with linespoints pt shape[nth(i)] ps 0.8 lw 2 \
     dt dash(i) lc rgb colour[nth(i)] title value(sprintf('name_%d', i))
