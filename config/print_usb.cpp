#include "config/print_usb.h"

#include "config/compile_usb.h"
#include "config/number.h"
#include "config/print_axis.h"

namespace hapticd::config {
namespace {

std::string selection_text(const usb::Selection& selection) {
  std::string text = hex_pair_text(selection.vendor, selection.product);
  if (!selection.serial.empty()) text += ", serial " + selection.serial;
  if (!selection.path.empty()) text += ", at port " + selection.path;
  if (selection.interface) text += ", interface " + std::to_string(*selection.interface);
  if (selection.usage)
    text += ", usage " + hex_pair_text(*selection.usage >> 16, *selection.usage & 0xffff);
  return text;
}

std::string transport_text(const usb::Selection& selection) {
  if (selection.transport == usb::Transport::hidapi) return "hidapi";
  return "libusb, " + std::to_string(selection.reads) + " reads in flight";
}

}  // namespace

std::string usb_text(const Compiled& compiled, std::size_t device) {
  const auto& usb = compiled.usb[device];
  if (!usb) return {};
  const auto time = [](double seconds) { return with_unit(seconds, "s"); };
  return "  usb: " + selection_text(usb->selection) + "; by " + transport_text(usb->selection) +
         "\n  samples at most " + time(usb->arrival_age_s) + " old when they arrive and " +
         time(usb->worst_sample_age_s) + " when they are used, sent within " + time(usb->send_s) +
         ", needs a latency of " + time(least_latency_s(*usb, waits_s(compiled))) +
         "\n  zero force after " + time(usb->watchdog_s) + " without a command, lost after " +
         time(usb->silence_s) + " without a sample\n";
}

}  // namespace hapticd::config
