# A scene as a surface with its mesh, y up, axes to one scale; once for each frame of a motion.
# Needs: $faces (corners x,z,y of a face, closed, two blank lines after it), $pins, $stiff (the same) where
# has_pins, has_stiff; $planes, $obstacles (as $faces) and how large their faces are, `behind`, where has_obstacles; edges
# (whether to draw the faces' edges), x_mid, z_mid, y_mid, half (of the cube that is seen),
# kind: page (PNG without background, for light and dark pages), white (PNG) or gif; first (1; the script sets it to 0).
# Draws to stdout.

if (first) {
    if (kind eq 'gif') {
        set terminal gif animate delay 5 loop 0 size 640,480 background '#ffffff'
    } else {
        if (kind eq 'page') {
            set terminal pngcairo transparent size 1120,840
        } else {
            set terminal pngcairo size 1120,840 background '#ffffff'
        }
    }
    first = 0
}
set datafile separator ','

# A cube around it, so that the axes have one scale.
set xrange [x_mid - half:x_mid + half]
set yrange [z_mid - half:z_mid + half]
set zrange [y_mid - half:y_mid + half]

set view 62, 30, has_obstacles ? 1.2 : 1.5  # obstacles below fill the height, too
set view equal xyz
set xyplane at y_mid - half
unset border
unset tics
unset colorbox
unset key
if (edges) {
    set style fill solid 1 border lc rgb '#0a3d62'
    set pm3d depthorder border lc rgb '#0a3d62' lw 0.6
} else {
    set style fill solid 1 noborder
    set pm3d depthorder
}
set multiplot
if (has_obstacles) {
    # What lies on an obstacle is not to be hidden by a face of it that reaches further to the front: its faces count as
    # further away than they are, along the line of sight, so that they are seen where they are; and those of planes
    # twice as far, as other obstacles stand on them.
    x_deep = -behind * sin(62 * pi / 180) * sin(30 * pi / 180)
    y_deep = behind * sin(62 * pi / 180) * cos(30 * pi / 180)
    z_deep = -behind * cos(62 * pi / 180)
    splot $planes using ($1 + 2 * x_deep):($2 + 2 * y_deep):($3 + 2 * z_deep) with polygons fillcolor rgb '#e8d3a8', \
        $obstacles using ($1 + x_deep):($2 + y_deep):($3 + z_deep) with polygons fillcolor rgb '#e8d3a8', \
        $faces using 1:2:3 with polygons fillcolor rgb '#8fbbdc'
} else {
    splot $faces using 1:2:3 with polygons fillcolor rgb '#8fbbdc'
}
# In front of all faces, which gnuplot draws last in a plot.
if (has_stiff) {
    splot $stiff using 1:2:3 with lines lw 4 lc rgb '#d55e00'
}
if (has_pins) {
    splot $pins using 1:2:3 with points pt 13 ps 1.3 lc rgb '#e69f00'
}
unset multiplot
