// The one device that a selection means. None or several are refused in words that say what there is and how to choose.
#pragma once
#include <string>
#include <vector>

#include "drivers/usb/host.h"
#include "drivers/usb/options.h"
#include "drivers/usb/sysfs.h"

namespace hapticd::usb {

/// "0403:cb48".
std::string id_of(std::uint16_t vendor, std::uint16_t product);
/// "Novint Falcon (0403:cb48, serial X, port 1-2)".
std::string words(const About& about);
/// Of top collections, "ff00:0001"; "none that can be read" of a descriptor that is none.
std::string usages_of(const std::vector<std::uint8_t>& report_descriptor);

struct ChosenInterface {
  PluggedDevice device{};
  Interface interface {};
};
/// With both endpoints.
Opened<ChosenInterface> choose_bulk(const Selection& selection, std::uint8_t bulk_in,
                                    std::uint8_t bulk_out, const Roots& roots);
/// With an interrupt IN endpoint. An interface whose descriptor the kernel has not read may be the one that is meant by
/// `selection.usage`: whoever opens it looks.
Opened<ChosenInterface> choose_hid_interface(const Selection& selection, const Roots& roots);
Opened<HidNode> choose_hid_node(const Selection& selection, const Roots& roots);

/// Has one of its top collections the usage that is wanted, if one is?
bool has_usage(const std::vector<std::uint8_t>& report_descriptor, const Selection& selection);

tl::unexpected<NotOpened> refused(ExitCode code, std::string text);

}  // namespace hapticd::usb
