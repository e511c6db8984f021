# GPIO lines through the real libgpiod: both directions, edges, names, busy and missing lines, the cell's permission.
# modules: gpio-sim
# targets: vm_lines
# programs: gpiomon gpioinfo
exec vm_lines --use-colour no
