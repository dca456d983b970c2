# Regions of two methods with a damped cloth in them, at a step below the limit and at one above.
# Needs: type ('svg' or 'png'), output_file, data (path without suffix), steps, and for each method METHOD_window
# (x_min x_max y_min y_max), METHOD_below and METHOD_above (h [s], h/limit, eigenpairs outside, whether a run diverged).
# Reads data_METHOD_pieces.csv, data_METHOD_boundary.csv, data_METHOD_{below,above}_{modes,outline}.csv.

if (type eq 'svg') {
    set terminal svg size 1050,860 font 'DejaVu Sans,13' background '#ffffff'
} else {
    set terminal pngcairo size 1310,1075 font 'DejaVu Sans,12' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

stable_colour = '#a6cee8'
edge_colour = '#0a3d62'
range_colour = '#e69f00'
inside_colour = '#0072b2'
outside_colour = '#d55e00'

set multiplot layout 2,2 margins 0.065,0.985,0.125,0.865 spacing 0.07,0.14 \
    title "A net with dampers along its springs, in the regions of two methods\n{/*0.75 W holds (h v*D'v, h² v*K'v) of every unit vector v; a step is proved where W lies inside, and unstable once an eigenpair does not}" \
    font ',15'
set border 3
set tics out nomirror font ',10'
set xlabel 'X = h d' offset 0, 0.5
set ylabel 'Y = h² k' offset 1, 0
unset key
methods = 'explicit_euler rk4'
files = 'explicit-euler rk4'
titles = '"explicit Euler" "RK4"'
do for [m = 1:2] {
    window = value(word(methods, m) . '_window')
    set xrange [word(window, 1) + 0:word(window, 2) + 0]
    set yrange [word(window, 3) + 0:word(window, 4) + 0]
    do for [side in 'below above'] {
        facts = value(word(methods, m) . '_' . side)
        region = data . '_' . word(files, m)
        set title sprintf("%s, h = %.4g ms, %.4g of its limit\n{/*0.8 %s eigenpairs outside; a run of %d steps %s}", \
                          word(titles, m), 1e3 * word(facts, 1), word(facts, 2) + 0, word(facts, 3), steps, \
                          word(facts, 4) + 0 ? 'diverges' : 'stays bounded') font ',13'
        plot region . '_pieces.csv' using 1:2:3 with filledcurves fillcolor rgb stable_colour, \
             region . '_' . side . '_outline.csv' using 1:2 with filledcurves closed fillcolor rgb range_colour \
                 fillstyle transparent solid 0.3 noborder, \
             region . '_boundary.csv' using 2:3 with lines lw 2 lc rgb edge_colour, \
             region . '_' . side . '_outline.csv' using 1:2 with lines lw 1.5 lc rgb range_colour, \
             region . '_' . side . '_modes.csv' using ($3 <= 1 ? $1 : NaN):2 with points pt 7 ps 0.45 \
                 lc rgb inside_colour, \
             '' using ($3 <= 1 ? NaN : $1):2 with points pt 2 ps 1.1 lw 2 lc rgb outside_colour
    }
}

unset title
unset xlabel
unset ylabel
unset border
unset tics
set key at screen 0.5, 0.05 center top horizontal samplen 2 font ',11.5'
set size 1, 1
set origin 0, 0
set xrange [0:1]
set yrange [0:1]
set lmargin at screen 0
set rmargin at screen 1
set bmargin at screen 0
set tmargin at screen 0.1
plot NaN with filledcurves fillcolor rgb stable_colour title 'stable', \
     NaN with lines lw 1.5 lc rgb range_colour title 'W of the net', \
     NaN with points pt 7 ps 0.6 lc rgb inside_colour title 'eigenpair, |λ| ≤ 1', \
     NaN with points pt 2 ps 1.1 lw 2 lc rgb outside_colour title 'eigenpair, |λ| > 1'
unset multiplot
