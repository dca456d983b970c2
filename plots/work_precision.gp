# Error against cost, a row of two panels per contest: CPU seconds, and passes over all springs or blocks.
# Needs: type ('svg' or 'png'), output_file, footer, panels, repetitions, designed, keys and for each of them key_j,
# the names of all; for each contest data_i, title_i, series_i and for each of these name_i_j, floor_i (100 times the
# reference's own error), and for the orders 1 and 4 order<p>_i (0 or 1), order<p>_x_i, order<p>_n_i, order<p>_y_i: a
# point that the line of that order passes.
# Reads data_i: blocks of seconds,least,most,error,equivalents,at_limit,outcome (0 finished, 1 diverged, 2 timed out).

height = 425 * panels + 185
if (type eq 'svg') {
    set terminal svg size 1100,height font 'DejaVu Sans,12' background '#ffffff'
} else {
    set terminal pngcairo size 1240,height * 1.127 font 'DejaVu Sans,11' background '#ffffff'
}
set output output_file
set datafile separator ','
set datafile missing ''
set encoding utf8

# Okabe and Ito's colours, and a point of its own for each; implicit Euler's three tolerances are told apart by both.
has(name, part) = strstrt(name, part) > 0
colour(name) = has(name, 'SDIRK2') ? 0xaa3377 : has(name, 'BDF2') ? 0x661100 : has(name, 'DIRK') ? 0xcc6677 : has(name, 'msbdf') ? 0x88a0dd : \
    has(name, 'linearized explicit') ? 0xe69f00 : has(name, 'linearized Runge') ? 0x56b4e9 : \
    has(name, 'explicit Euler') ? 0xd55e00 : has(name, 'symplectic') ? 0x009e73 : \
    has(name, 'CG 0.01') ? 0x882255 : has(name, 'CG 1e-08') ? 0x332288 : has(name, 'implicit') ? 0x000000 : \
    has(name, 'Runge-Kutta 4') ? 0x0072b2 : has(name, 'ARKODE') ? 0x7a5195 : has(name, 'CVODE') ? 0x8c564b : \
    has(name, 'odeint') ? 0x999933 : has(name, 'bsimp') ? 0x117733 : has(name, 'GSL') ? 0x777777 : 0xcc79a7
point(name) = has(name, 'SDIRK2') ? 3 : has(name, 'BDF2') ? 1 : has(name, 'DIRK') ? 15 : has(name, 'msbdf') ? 6 : has(name, 'bsimp') ? 4 : has(name, 'linearized explicit') ? 4 : has(name, 'linearized Runge') ? 6 : has(name, 'explicit Euler') ? 5 : \
    has(name, 'symplectic') ? 13 : has(name, 'CG 0.01') ? 11 : has(name, 'CG 1e-08') ? 15 : has(name, 'implicit') ? 2 : \
    has(name, 'Runge-Kutta 4') ? 7 : has(name, 'ARKODE') ? 8 : has(name, 'CVODE') ? 10 : has(name, 'odeint') ? 12 : \
    has(name, 'GSL') ? 14 : 9
library(name) = has(name, 'ARKODE') || has(name, 'CVODE') || has(name, 'odeint') || has(name, 'GSL')
dash(name) = library(name) ? 2 : 1
key_name(j) = value(sprintf('key_%d', j))
name(j) = value(sprintf('name_%d_%d', row, j))
# By the number of a block, from 0.
colour_of(block) = colour(name(int(block) + 1))
point_of(block) = point(name(int(block) + 1))
library_of(block) = library(name(int(block) + 1))
libraries = 0
do for [j = 1:keys] {
    libraries = libraries || library(key_name(j))
}
of(what, i) = value(sprintf('%s_%d', what, i))

set logscale xy
set samples 500
set format x '10^{%T}'
set format y '10^{%T}'
set border 3
set tics out nomirror
set grid lw 0.5 lc rgb '#e4e4e4'
largest = 10.
outside = 1e9   # of every range: nothing is drawn
shown(error) = error > largest ? largest : error
set object 1 rectangle from graph 0, first 12 to graph 1, first 100 behind fillcolor rgb '#f2f2f2' fillstyle solid noborder

# Panel `row` from the top, column 0 or 1.
top_of(row) = 1 - (50. + 425. * (row - 1)) / height
bottom_of(row) = 1 - (50. + 425. * (row - 1) + 320.) / height

set multiplot
set label 1 footer at screen 0.01, 14. / height left font ',8' textcolor rgb '#555555'
set label 2 sprintf('Bars from the fastest to the slowest of %d runs. Large rings: the largest step below the stability limit (known limits only).', \
    repetitions) at screen 0.01, 32. / height left font ',8' textcolor rgb '#555555'
set label 3 'Passes: force evaluations, Hessian assemblies and products with K or D, each of which goes over all springs or blocks once.' \
    at screen 0.01, 50. / height left font ',8' textcolor rgb '#555555'

do for [row = 1:panels] {
    data = of('data', row)
    do for [side = 0:1] {
        set tmargin at screen top_of(row)
        set bmargin at screen bottom_of(row)
        set lmargin at screen (side == 0 ? 0.075 : 0.575)
        set rmargin at screen (side == 0 ? 0.485 : 0.985)
        set title (side == 0 ? of('title', row) : '') font ',12' offset (side == 0 ? 27 : 0), 0
        set xlabel (side == 0 ? 'CPU time   (s)' : 'passes over all springs or blocks') offset 0, 0.3
        set ylabel (side == 0 ? 'error of the trajectory (relative, L₂)' . (designed ? ' against own damping' : '') : '')
        set label 11 'diverged ×, out of time △' at graph 0, graph 1.03 left font ',8' textcolor rgb '#777777'
        set label 12 '100 × error of the reference' at graph 0.01, first of('floor', row) offset 0, 0.5 left \
            font ',8' textcolor rgb '#777777'
        x_of(p) = of(side == 0 ? sprintf('order%d_x', p) : sprintf('order%d_n', p), row)
        line(p, x) = of(sprintf('order%d_y', p), row) * (x / x_of(p))**(-p) * 2.5
        in_reach(p, x) = (of(sprintf('order%d', p), row) && x > x_of(p) / 30 && x < x_of(p) * 1.3 && line(p, x) < largest) ? line(p, x) : NaN
        if (side == 0 && row == panels) {
            set key at screen 0.5, 150. / height center top vertical maxrows 4 Left reverse samplen 2 spacing 1.2 font ',10'
        } else {
            unset key
        }
        c = side == 0 ? 1 : 5
        set autoscale x
        set yrange [*:*]
        least = 1e300
        most = 0
        do for [j = 1:of('series', row)] {
            stats data index j - 1 using c nooutput
            least = STATS_min < least ? STATS_min : least
            most = STATS_max > most ? STATS_max : most
        }
        set yrange [*:100]
        set xrange [least / 1.5:most * 1.5]
        ordered = designed ? 0 : 1
        bars = side == 0 ? 1 : 0
        plot for [k = 1:bars] data using 1:(shown($4)):2:3:(colour_of(column(-2))) with xerrorbars pt 0 lw 1 \
                 lc rgb variable notitle, \
             data using c:(library_of(column(-2)) ? NaN : shown($4)):(point_of(column(-2))):(colour_of(column(-2))) \
                 with linespoints pt variable ps 1 lw 1.6 lc rgb variable notitle, \
             for [k = 1:libraries] data using \
                 c:(library_of(column(-2)) ? shown($4) : NaN):(point_of(column(-2))):(colour_of(column(-2))) \
                 with linespoints pt variable ps 1 lw 1 dt 2 lc rgb variable notitle, \
             data using c:($6 == 1 ? shown($4) : outside):(colour_of(column(-2))) with points pt 6 ps 2 lw 1.5 \
                 lc rgb variable notitle, \
             data using c:($7 == 1 ? 22 : outside):(colour_of(column(-2))) with points pt 2 ps 0.9 lw 1.5 \
                 lc rgb variable notitle, \
             data using c:($7 == 2 ? 55 : outside):(colour_of(column(-2))) with points pt 8 ps 1 lw 1.5 \
                 lc rgb variable notitle, \
             for [k = 0:1] order = 1 + 3 * k, in_reach(order, x) with lines lw 4 dt 3 lc rgb '#bbbbbb' notitle, \
             of('floor', row) with lines lw 1 dt 3 lc rgb '#777777' notitle, \
             for [j = 1:keys] keyentry with linespoints pt point(key_name(j)) ps 1 \
                 lw (library(key_name(j)) ? 1 : 1.6) dt dash(key_name(j)) lc rgb colour(key_name(j)) title key_name(j), \
             for [k = 1:ordered] keyentry with lines lw 4 dt 3 lc rgb '#bbbbbb' title 'slopes of order 1 and 4'
        unset label 1
        unset label 2
        unset label 3
    }
}
unset multiplot
