# Cells of the X-Y plane whose simulation disagrees with the exact region, method by method, and a pendulum.
# Needs: type ('svg' or 'png'), output_file, data (path without suffix), cells, steps, pendulum_step, and for each method
# a string of x_min x_max y_min y_max disagreements band outside_band.
# Reads data_METHOD.csv, data_METHOD_boundary.csv, data_pendulum.csv.

if (type eq 'svg') {
    set terminal svg size 1150,760 font 'DejaVu Sans,13' background '#ffffff'
} else {
    set terminal pngcairo size 1440,950 font 'DejaVu Sans,12' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

edge_colour = '#0a3d62'
bounded_colour = '#0072b2'
diverged_colour = '#d55e00'

set multiplot layout 2,3 margins 0.055,0.985,0.13,0.87 spacing 0.06,0.15 \
    title sprintf("Simulation against theory: %d × %d oscillators a method, %d steps each\n{/*0.75 only the cells that disagree are drawn; beyond the band |ρ − 1| ≥ %s there is none where a title says 0}", \
                  cells, cells, steps, word(explicit_euler, 6)) font ',15'
set border 3
set tics out nomirror font ',10'
set xlabel 'X = h d' offset 0, 0.5
set ylabel 'Y = h² k' offset 1, 0

methods = 'explicit_euler rk2 rk4 implicit_euler symplectic_euler'
titles = '"explicit Euler" "RK2" "RK4" "implicit Euler" "symplectic Euler"'
thin = type eq 'svg' ? 4 : 1  # of the cells along the boundary every fourth is enough to see, and a quarter of the file
unset key
do for [i = 1:5] {
    name = word(methods, i)
    file = data . '_' . (name eq 'rk2' || name eq 'rk4' ? name : name[1:strlen(name) - 6] . '-euler')
    facts = value(name)
    set xrange [word(facts, 1) + 0:word(facts, 2) + 0]
    set yrange [word(facts, 3) + 0:word(facts, 4) + 0]
    set title sprintf("%s\n{/*0.8 %s differ, %s outside the band}", word(titles, i), word(facts, 5), word(facts, 7)) \
        font ',13'
    plot file . '_boundary.csv' using 2:3 with lines lw 1 lc rgb edge_colour, \
         file . '.csv' every thin using ($4 == 0 ? $1 : NaN):2 with points pt 7 ps 0.3 lc rgb bounded_colour, \
         '' every thin using ($4 == 1 ? $1 : NaN):2 with points pt 7 ps 0.3 lc rgb diverged_colour
}

set key at graph 0.02, 0.98 top left Left reverse samplen 2 font ',10'
set title sprintf("A pendulum on a stiff spring\n{/*0.8 h = %.4g s, new linearization every 0.05 s}", pendulum_step) font ',13'
set xlabel 'time   (s)' offset 0, 0.5
set ylabel 'distance from the pivot   (m)' offset 1, 0
set xrange [0:*]
set yrange [0.85:1.2]
plot data . '_pendulum.csv' using 1:2 with lines lw 1.5 lc rgb diverged_colour title 'linearized explicit Euler', \
     '' using 1:3 with lines lw 1.5 lc rgb bounded_colour title 'symplectic Euler'

unset title
unset xlabel
unset ylabel
unset border
unset tics
set key at screen 0.5, 0.045 center top horizontal samplen 2 font ',11'
set size 1, 1
set origin 0, 0
set xrange [0:1]
set yrange [0:1]
set lmargin at screen 0
set rmargin at screen 1
set bmargin at screen 0
set tmargin at screen 0.1
plot NaN with lines lw 1.5 lc rgb edge_colour title 'exact boundary', \
     NaN with points pt 7 lc rgb bounded_colour title 'unstable by theory, stayed bounded', \
     NaN with points pt 7 lc rgb diverged_colour title 'stable by theory, passed the threshold'
unset multiplot
