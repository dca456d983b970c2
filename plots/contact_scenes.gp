# Frames of cloth against obstacles, a scene a row, to one scale within it.
# Needs: type ('svg' or 'png'), output_file, data (x,z,y by rows; blocks: of each scene and frame the cloth, then its
# obstacles), frames, title_0, duration_0, ...

if (type eq 'svg') {
    set terminal svg size 1200,960 font 'DejaVu Sans,13' background '#ffffff'
} else {
    set terminal pngcairo size 1500,1200 font 'DejaVu Sans,12.5' background '#ffffff'
}
set output output_file
set datafile separator ','
set encoding utf8

obstacles = '2 1 2'
unset border
unset tics
unset colorbox
unset key
set view equal xyz
set xyplane 0
set palette defined (0 '#8fbbdc', 1 '#d9cbb0')
set cbrange [0:1]
set pm3d depthorder border lc rgb '#5f6f7a' lw 0.2 lighting primary 0.45 specular 0.1
set multiplot
block = 0
do for [s = 0:2] {
    n = int(word(obstacles, s + 1))
    last = block + frames * (n + 1) - 1
    set xrange [*:*] # stats leaves out what is outside of them
    set yrange [*:*]
    set zrange [*:*]
    stats data index block:last using 1 nooutput name 'X'
    stats data index block:last using 2 nooutput name 'Z'
    stats data index block:last using 3 nooutput name 'Y'
    set xrange [X_min:X_max]
    set yrange [Z_min:Z_max]
    set zrange [Y_min:Y_max]
    set view 68, s == 2 ? 15 : 30, 1.35
    do for [f = 0:frames - 1] {
        set origin f * 1.0 / frames, 0.65 - s * 0.333
        set size 1.0 / frames, 0.31
        time = value(sprintf('duration_%d', s)) * f / (frames - 1)
        unset label
        if (f == 0) { set label value(sprintf('title_%d', s)) at screen 0.02, 0.985 - s * 0.333 font ',15' }
        set label sprintf('%.2f s', time) at screen (f + 0.5) / frames, 0.955 - s * 0.333 center
        splot data index block using 1:2:3:(0) with pm3d, \
              for [o = 1:n] data index block + o using 1:2:3:(1) with pm3d
        block = block + n + 1
    }
}
unset multiplot
