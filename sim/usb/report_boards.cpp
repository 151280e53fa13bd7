// Boards that exist.
#include "sim/usb/report_board.h"

namespace hapticd::sim::usb {

ReportBoardOptions wooden_haptics() {
  ReportBoardOptions board;
  board.vendor = 0x1234;
  board.product_id = 0x0006;
  board.manufacturer = "mbed.org";
  board.product = "WoodenHaptics";
  board.serial = "0123456789";
  for (std::size_t i = 0; i < 3; ++i) {
    board.positions.push_back({.offset_bits = 16 * i});
    board.efforts.push_back({.field = {.offset_bits = 16 * i}, .per_raw = 1e-3, .most = 3});
  }
  board.sequence = ReportField{.offset_bits = 48, .is_signed = false};
  board.watchdog_s = 0.5;
  board.oldest_first = true;
  board.queue = 2;
  return board;
}

ReportBoardOptions teensy_raw_hid(std::size_t motors) {
  ReportBoardOptions board;
  board.vendor = 0x16c0;
  board.product_id = 0x0486;
  board.manufacturer = "Teensyduino";
  board.product = "Teensyduino RawHID";
  board.serial = "12345";
  board.interfaces = {{.in_bytes = 64, .out_bytes = 64, .in_endpoint = 3, .out_endpoint = 4},
                      {.usage_page = 0xffc9,
                       .usage = 0x0004,
                       .in_bytes = 64,
                       .out_bytes = 32,
                       .in_endpoint = 1,
                       .out_endpoint = 2}};
  board.sequence = ReportField{.width_bits = 32, .is_signed = false};
  for (std::size_t i = 0; i < motors; ++i) {
    board.positions.push_back({.offset_bits = 32 + 32 * i, .width_bits = 32});
    board.efforts.push_back({.field = {.offset_bits = 16 * i}, .per_raw = 1e-3});
  }
  for (std::size_t i = 0; i < 8; ++i)
    board.buttons.push_back({.offset_bits = 8 * 40 + i, .width_bits = 1, .is_signed = false});
  board.heartbeat = ReportField{.offset_bits = 8 * 63, .width_bits = 8, .is_signed = false};
  board.watchdog_s = 0.1;
  return board;
}

}  // namespace hapticd::sim::usb
