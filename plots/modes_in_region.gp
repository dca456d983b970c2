# The region of a method with the modes of a structure in it, at the step to use and at the user's.
# Needs: $pieces (x,y_lower,y_upper), $boundary, $modes_1, $modes_2 (x,y), method, name_1, name_2, has_second, is_line,
# x_min x_max y_min y_max. Draws an SVG to stdout, in the colours that a report's page knows.

set terminal svg size 620,520 font 'sans-serif,15' dynamic
set datafile separator ','
set encoding utf8

stable_colour = '#bcdcef'
edge_colour = '#0a3d62'
first_colour = '#d55e00'
second_colour = '#7a1f00'
beside_colour = '#555555'

set title method noenhanced font ',17'
set xrange [x_min:x_max]
set yrange [y_min:y_max]
set xlabel 'X = h d   (step × damping)'
set ylabel 'Y = h² k   (step² × stiffness)'
set border 3
set tics out nomirror
set xzeroaxis lt 1 lw 1 lc rgb beside_colour
set yzeroaxis lt 1 lw 1 lc rgb beside_colour
set key at screen 0.53, 0.005 center bottom vertical maxrows (has_second ? 3 : 2) Left reverse samplen 2.5 spacing 1.2 noenhanced font ',13'
set bmargin at screen (has_second ? 0.31 : 0.27)
set samples 300
set clip two

if (is_line) {
    plot $pieces using 1:2:3 with filledcurves fillcolor rgb stable_colour title 'stable', \
         x**2 / 4 with lines lw 1 dt (7, 5) lc rgb beside_colour title 'critical damping', \
         $boundary using 1:2 with lines lw 2.5 lc rgb edge_colour title 'its boundary', \
         for [i = 1:has_second] $modes_2 using 1:2 with linespoints pt 8 ps 1.2 lw 2.5 dt (10, 4) lc rgb second_colour \
             title name_2, \
         $modes_1 using 1:2 with linespoints pt 7 ps 0.9 lw 4 lc rgb first_colour title name_1
} else {
    plot $pieces using 1:2:3 with filledcurves fillcolor rgb stable_colour title 'stable', \
         x**2 / 4 with lines lw 1 dt (7, 5) lc rgb beside_colour title 'critical damping', \
         $boundary using 1:2 with lines lw 2.5 lc rgb edge_colour title 'its boundary', \
         for [i = 1:has_second] $modes_2 using 1:2 with filledcurves closed fillcolor rgb second_colour \
             fillstyle transparent solid 0.12 noborder notitle, \
         for [i = 1:has_second] $modes_2 using 1:2 with lines lw 2.5 dt (10, 4) lc rgb second_colour title name_2, \
         $modes_1 using 1:2 with filledcurves closed fillcolor rgb first_colour fillstyle transparent solid 0.3 \
             noborder notitle, \
         $modes_1 using 1:2 with lines lw 3 lc rgb first_colour title name_1
}
