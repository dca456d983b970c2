# The stable region of one method in the X-Y plane.
# Needs: type ('svg' or 'png'), output_file, data (path without suffix), method, number ('' or the paper's figure),
# x_min x_max y_min y_max, bounded, apex_x apex_y, has_line line_x, has_over over_x over_y,
# cells steps differ outside band.
# Reads data_pieces.csv, data_boundary.csv, data_cells.csv.

if (type eq 'svg') {
    set terminal svg size 800,640 font 'DejaVu Sans,15' background '#ffffff'
} else {
    set terminal pngcairo size 1000,800 font 'DejaVu Sans,13' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

# Okabe and Ito's colours: told apart with any colour vision, and in grey.
stable_colour = '#a6cee8'
over_colour = '#f6d9a0'
edge_colour = '#0a3d62'
parabola_colour = '#555555'
line_colour = '#d55e00'
cell_colour = '#0072b2'
diverged_colour = '#7a1f00'

set xrange [x_min:x_max]
set yrange [y_min:y_max]
set xlabel 'X = h d   (step × damping, dimensionless)'
set ylabel 'Y = h² k   (step² × stiffness, dimensionless)'
set xzeroaxis lt 1 lw 1 lc rgb '#999999'
set yzeroaxis lt 1 lw 1 lc rgb '#999999'
set tics out nomirror
set border 3
set key at screen 0.53, 0.155 top center vertical maxrows 4 Left reverse samplen 2.5 spacing 1.3 font ',11'
set bmargin at screen 0.24

heading = method . ': where a mode is stable' . (number ne '' ? '  (Fig. ' . number . ' of the paper)' : '')
verdict = sprintf('%d oscillators simulated for %d steps; %d differ from theory, %d of them where |ρ − 1| ≥ %.2g', \
                  cells, steps, differ, outside, band)
set title heading . "\n{/*0.8 " . verdict . '}'

positive(x) = x < 0 ? 0 : x
dx = (x_max - x_min) / 90.
dy = (y_max - y_min) / 40.
if (bounded) {
    set object 1 circle at first apex_x, apex_y radius graph 0.008 front fillstyle solid 1.0 \
        fillcolor rgb line_colour noclip
    apex = sprintf('largest Y = %.5g at X = %.5g', apex_y, apex_x)
    if (apex_x > (x_min + x_max) / 2) {
        set label 1 apex at first apex_x - dx, apex_y + dy right front
    } else {
        set label 1 apex at first apex_x + dx, apex_y + dy left front
    }
}

set samples 400
if (has_line) {
    set arrow 1 from first line_x, 0 to first apex_x, apex_y nohead front lw 3 lc rgb line_colour
}

if (over_y < 0) {
    set style textbox opaque fillcolor rgb over_colour noborder
    set label 2 'over-stable' at first over_x, over_y center front boxed font ',15'
}

plot for [i = 1:has_over] data . '_pieces.csv' using 1:2:3 with filledcurves fillcolor rgb over_colour \
         title 'over-stable: d < 0 or k < 0 grows, the method damps it', \
     data . '_pieces.csv' using ($1 >= 0 && $3 > 0 ? $1 : NaN):(positive($2)):3 with filledcurves fillcolor rgb stable_colour \
         title 'stable', \
     data . '_cells.csv' using ($4 == 0 ? $1 : NaN):2 with points pt 7 ps 0.3 lc rgb cell_colour \
         title 'simulated: stays bounded', \
     '' using ($4 == 1 ? $1 : NaN):2 with points pt 2 ps 0.4 lw 0.8 lc rgb diverged_colour \
         title 'simulated: diverges', \
     x**2 / 4 with lines lw 1.5 dt (8, 5) lc rgb parabola_colour title 'X² = 4Y: critical damping', \
     data . '_boundary.csv' using 2:3 with lines lw 2.5 lc rgb edge_colour title 'exact boundary: |λ| = 1', \
     for [i = 1:has_line] keyentry with lines lw 3 lc rgb line_colour \
         title 'Rayleigh damping: (h d₀, 0) to the apex'
