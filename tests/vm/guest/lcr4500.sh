# A LightCrafter 4500 as a USB HID gadget with its ids, and the driver that finds it as /dev/hidraw.
# modules: dummy_hcd libcomposite usb_f_hid usbhid hid-generic
# targets: vm_lcr4500
# limit_s: 180
set -e
gadget=/sys/kernel/config/usb_gadget/dlpc350
mkdir -p $gadget
cd $gadget
echo 0x0451 >idVendor
echo 0x6401 >idProduct
mkdir -p strings/0x409 configs/c.1 functions/hid.0
echo DLPC350 >strings/0x409/product
echo 0 >functions/hid.0/protocol
echo 0 >functions/hid.0/subclass
echo 64 >functions/hid.0/report_length
# Vendor-defined: 64 bytes in, 64 bytes out, no report numbers.
printf '\006\000\377\011\001\241\001\025\000\046\377\000\165\010\225\100\011\001\201\002\225\100\011\001\221\002\300' \
  >functions/hid.0/report_desc
ln -sf $gadget/functions/hid.0 configs/c.1/
cd /tmp
vm_lcr4500
