# Which runs of a scene and of its linear system diverge, over h relative to the limit.
# Needs: type ('svg' or 'png'), output_file, data (path without suffix), duration [s], linear_steps.
# Reads data_cloth.csv (scene,damping,method,system,ratio,h,steps,diverged), data_safety.csv (a row per scene, damping
# and method: ...,bounded_ratio,k0_growth,needed_factor).

if (type eq 'svg') {
    set terminal svg size 1150,680 font 'DejaVu Sans,12' background '#ffffff'
} else {
    set terminal pngcairo size 1440,850 font 'DejaVu Sans,11.5' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

bounded_colour = '#0072b2'
diverged_colour = '#d55e00'

# Rows by method and damping, in the order of the first scene.
rows = 0
array row_name[100]
scenes = 0
array scene_name[20]
row_of(key) = (found = 0, sum [r = 1:rows] (found = row_name[r] eq key ? r : found, 0), found > 0 ? found : \
               (rows = rows + 1, row_name[rows] = key, rows))
scene_of(key) = (found = 0, sum [s = 1:scenes] (found = scene_name[s] eq key ? s : found, 0), found > 0 ? found : \
                 (scenes = scenes + 1, scene_name[scenes] = key, scenes))
key_of(method, damping) = method . ', ' . damping
set table $ignored
plot data . '_safety.csv' every ::1 using (row_of(key_of(strcol(3), strcol(2)))):(scene_of(strcol(1))) with points
unset table

set multiplot layout 1, scenes margins 0.265, 0.985, 0.15, 0.86 spacing 0.02 \
    title sprintf("Cloth against its predicted limits: which runs diverge\n{/*0.75 the limit is that of the linear system at the start; scenes run for %g s, linear systems for %d steps}", \
                  duration, linear_steps) font ',15'
set border 3
set tics out nomirror
set xrange [0.45:1.55]
set yrange [rows + 0.7:0.3]
set xtics 0.5, 0.25, 1.5
set xlabel 'h / limit'
set grid x lw 0.5 lc rgb '#dddddd'
set arrow 1 from 1, graph 0 to 1, graph 1 nohead lw 1.5 dt 2 lc rgb '#555555'
unset key
do for [s = 1:scenes] {
    set title scene_name[s] font ',13'
    unset ytics
    if (s == 1) {
        set ytics out nomirror font ',10'
        do for [r = 1:rows] { set ytics add (row_name[r] r) }
    }
    plot data . '_cloth.csv' every ::1 using 5:(strcol(1) eq scene_name[s] && strcol(4) eq 'linear' && $8 == 0 ? \
             row_of(key_of(strcol(3), strcol(2))) - 0.2 : NaN) with points pt 6 ps 0.6 lc rgb bounded_colour, \
         '' every ::1 using 5:(strcol(1) eq scene_name[s] && strcol(4) eq 'linear' && $8 == 1 ? \
             row_of(key_of(strcol(3), strcol(2))) - 0.2 : NaN) with points pt 2 ps 0.6 lc rgb diverged_colour, \
         '' every ::1 using 5:(strcol(1) eq scene_name[s] && strcol(4) eq 'scene' && $8 == 0 ? \
             row_of(key_of(strcol(3), strcol(2))) + 0.2 : NaN) with points pt 7 ps 0.9 lc rgb bounded_colour, \
         '' every ::1 using 5:(strcol(1) eq scene_name[s] && strcol(4) eq 'scene' && $8 == 1 ? \
             row_of(key_of(strcol(3), strcol(2))) + 0.2 : NaN) with points pt 1 ps 1.1 lw 2 lc rgb diverged_colour
}
unset title
unset xlabel
unset ytics
unset xtics
unset border
unset arrow 1
set key at screen 0.6, 0.06 center top horizontal samplen 1.5 font ',11'
set lmargin at screen 0
set rmargin at screen 1
set bmargin at screen 0
set tmargin at screen 0.1
set xrange [0:1]
set yrange [0:1]
plot NaN with points pt 6 ps 0.6 lc rgb bounded_colour title 'linear system bounded', \
     NaN with points pt 2 ps 0.6 lc rgb diverged_colour title 'linear system diverges', \
     NaN with points pt 7 ps 0.9 lc rgb bounded_colour title 'scene bounded', \
     NaN with points pt 1 ps 1.1 lw 2 lc rgb diverged_colour title 'scene diverges'
unset multiplot
