# Page flips on the kernel's virtual display, confirmed by its CRCs.
# modules: vkms
# targets: vm_display
# limit_s: 240
vm_display
