# A map of outcomes, method by case, in three columns of cases.
# Needs: type ('svg' or 'png'), output_file, data, cases, methods, summary, and for each method from 0 method_i.
# Reads data: case;method;outcome (0 right, 1 diverges, 2 refused, 3 no step, 4 limit, 5 wrong);as_expected;label.

columns = 3
rows = ceil(cases / (columns + 0.))
height = 250 + 15 * rows
if (type eq 'svg') {
    set terminal svg size 1400,height font 'DejaVu Sans,11' background '#ffffff'
} else {
    set terminal pngcairo size 1680,height * 1.2 font 'DejaVu Sans,11' background '#ffffff'
}
set output output_file
set datafile separator ';'
set encoding utf8

# Okabe and Ito's colours.
colour(outcome) = outcome == 0 ? 0x0072b2 : outcome == 1 ? 0xe69f00 : outcome == 2 ? 0x999999 : outcome == 3 ? 0xdddddd : \
    outcome == 4 ? 0x56b4e9 : 0xd55e00
name(i) = value(sprintf('method_%d', i))
top = 1 - 170. / height
bottom = 60. / height

set multiplot
set label 1 "Stiff, extreme and hostile cases by every method" at screen 0.5, 1 - 18. / height center font ',15'
set label 2 summary at screen 0.5, 1 - 38. / height center font ',10' textcolor rgb '#555555'
set border 0
set tics scale 0
set ytics noenhanced font ',9'
set xrange [-0.5:methods - 0.5]
set yrange [rows - 0.5:-0.5]
set format x ''
unset key
do for [column = 0:columns - 1] {
    first = column * rows
    set lmargin at screen (column + 0.59) / columns
    set rmargin at screen (column + 0.88) / columns
    set tmargin at screen top
    set bmargin at screen bottom
    do for [i = 0:methods - 1] {
        set label 10 + i name(i) at first i, screen top + 6. / height rotate by 60 left font ',8'
    }
    inside(case) = case >= first && case < first + rows
    plot data using (inside($1) ? $2 : NaN):($1 - first):(0.46):(0.44):(colour($3)):ytic(inside($1) ? strcol(5) : '') \
             with boxxyerror fillstyle solid noborder lc rgb variable, \
         '' using (inside($1) && $4 == 0 ? $2 : NaN):($1 - first) with points pt 2 ps 1 lw 2 lc rgb '#000000'
    unset label 1
    unset label 2
    set ytics () noenhanced
}
unset for [i = 10:10 + methods] label i
set lmargin at screen 0
set rmargin at screen 1
set bmargin at screen 0
set tmargin at screen 50. / height
unset xtics
unset ytics
set xrange [0:1]
set yrange [0:1]
set key at screen 0.5, 46. / height center top horizontal Left reverse maxcols 7 font ',10' samplen 1 width -4
plot NaN with points pt 5 ps 1.6 lc rgb colour(0) title 'right', \
     NaN with points pt 5 ps 1.6 lc rgb colour(1) title 'diverges, said', \
     NaN with points pt 5 ps 1.6 lc rgb colour(2) title 'input refused', \
     NaN with points pt 5 ps 1.6 lc rgb colour(3) title 'no stable step', \
     NaN with points pt 5 ps 1.6 lc rgb colour(4) title 'right, but too many steps', \
     NaN with points pt 5 ps 1.6 lc rgb colour(5) title 'wrong', \
     NaN with points pt 2 ps 1 lw 2 lc rgb '#000000' title 'not as expected'
unset multiplot
