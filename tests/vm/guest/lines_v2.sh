# The same as `lines`, through libgpiod 2 (Debian 13's).
# modules: gpio-sim
# prepare: tests/vm/build_gpiod2
# targets: vm_lines_v2
# programs: gpiomon gpioinfo
exec vm_lines_v2 --use-colour no
