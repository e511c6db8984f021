# The trigger source on lines of the PC: its sequence, counted and timed by the kernel's trace, and its faults.
# modules: gpio-sim
# targets: vm_line_trigger
# limit_s: 120
exec vm_line_trigger --use-colour no
