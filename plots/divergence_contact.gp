# Which share of runs in contact diverges at which part of the limit without contact.
# Needs: type ('svg' or 'png'), output_file, data (path), runs, steps.
# Reads the CSV: structure,method,model,ratio,runs,diverged.

if (type eq 'svg') {
    set terminal svg size 1150,720 font 'DejaVu Sans,12' background '#ffffff'
} else {
    set terminal pngcairo size 1440,900 font 'DejaVu Sans,11.5' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

inelastic_colour = '#d55e00'
impulses_colour = '#0072b2'
structures = 'chain net cloth'
methods = 'symplectic-euler implicit-damping-euler velocity-verlet rk4'
share(s, m, r) = (strcol(1) eq s && strcol(2) eq m && strcol(3) eq r) ? 100.0 * $6 / $5 : NaN

set multiplot layout 3, 4 margins 0.075, 0.985, 0.085, 0.85 spacing 0.02, 0.045 \
    title sprintf("In contact below the limit: the share of runs that diverge\n{/*0.75 random linear structures without damping, one particle held, between 1 to 4 walls: %d runs of up to %d steps at each place; the limit is that without contact}\n{/*0.75 diverged: a kinetic energy beyond 10^6 times that at the start, which is the watch of simulate over a linear system}", \
                  runs, steps) font ',15'
set border 3
set tics out nomirror
set xrange [0.48:1.01]
set yrange [-4:84]
set xtics 0.5, 0.1, 0.9
set grid lw 0.5 lc rgb '#dddddd'
do for [s = 1:3] {
    do for [m = 1:4] {
        structure = word(structures, s)
        method = word(methods, m)
        unset title
        if (s == 1) { set title method font ',12.5' }
        set format x ''
        unset xlabel
        if (s == 3) { set format x '%.1f'; set xlabel 'h / limit without contact' }
        set format y ''
        unset ylabel
        if (m == 1) { set format y '%.0f %%'; set ylabel structure font ',12.5' }
        unset key
        if (s == 1 && m == 1) { set key at graph 0.03, 0.95 left top Left reverse samplen 3 font ',11' }
        plot data every ::1 using 4:(share(structure, method, 'inelastic')) with linespoints \
                 pt 7 ps 0.9 lw 2 lc rgb inelastic_colour title 'inelastic', \
             '' every ::1 using 4:(share(structure, method, 'impulses')) with linespoints \
                 pt 5 ps 0.7 lw 2 lc rgb impulses_colour title 'impulses (the default)'
    }
}
unset multiplot
