// What stands beside every answer: objects that no proof covers, and effects that none does.
#pragma once
#include "control/design/check/tied_case.h"

namespace hapticd::check {

/// Objects that give energy of their own.
std::vector<ObjectNote> active_objects(const std::vector<DeviceAssumption>& assumed,
                                       const Tied& devices);
/// Those, and where the answer is no, bodies that no known theorem allows.
std::vector<ObjectNote> uncertified_objects(const TiedCase& given, const PassiveAnswer& answer);
/// Effects that no certificate is about. Quantisation by q: a tick leaks up to (q/2) |change of
/// force|, which dry friction of (K + 2 B/T) q/2 takes up (K over the joints).
std::vector<std::string> uncovered(const TiedCase& given, const PassiveAnswer& answer);

}  // namespace hapticd::check
