# The simulated devices themselves are there: without them no other test tells anything.
# modules: gpio-sim vkms dummy_hcd libcomposite usb_f_hid usb_f_acm usbhid
# programs: gpiodetect gpioinfo
set -e
chip=/sys/kernel/config/gpio-sim/proof
mkdir -p $chip/bank0
echo 4 >$chip/bank0/num_lines
echo proof >$chip/bank0/label
echo 1 >$chip/live
gpiodetect
gpiodetect | grep -q '\[proof\] (4 lines)'
echo 0 >$chip/live
rmdir $chip/bank0 $chip

ls /dev/dri /sys/kernel/debug/dri/0/crtc-0/crc
[ -e /dev/dri/card0 ]
ls /sys/class/udc
[ -e /sys/class/udc/dummy_udc.0 ]
