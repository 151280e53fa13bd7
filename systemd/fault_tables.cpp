// Prints the table of faults or of limits in the man page's source form (scdoc): hapticd(8) has no
// copy of its own that could fall behind the code.
#include <cstdio>
#include <string>
#include <string_view>

#include "control/core/fault.h"

namespace {

/// `command` in the table's texts becomes bold.
std::string marked_up(std::string_view text) {
  std::string out;
  for (const char c : text) out += c == '`' ? '*' : c;
  return out;
}

void print_entry(std::string_view name, const std::string& about, const std::string& action) {
  std::printf("*%.*s*\n\t%s.++\n_Do:_ %s.\n\n", static_cast<int>(name.size()), name.data(),
              about.c_str(), action.c_str());
}

void print_faults() {
  for (const hapticd::FaultEntry& entry : hapticd::fault_table()) {
    if (entry.code == hapticd::Fault::none) continue;
    print_entry(entry.name,
                marked_up(entry.meaning) + " (set by: " + std::string(entry.set_by) + ")",
                marked_up(entry.action));
  }
}

void print_limits() {
  for (const hapticd::LimitEntry& entry : hapticd::limit_table()) {
    print_entry(entry.name, marked_up(entry.meaning), marked_up(entry.action));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view which = argc == 2 ? argv[1] : "";
  if (which == "faults") {
    print_faults();
  } else if (which == "limits") {
    print_limits();
  } else {
    std::fputs("usage: fault_tables faults|limits\n", stderr);
    return 64;
  }
  return 0;
}
