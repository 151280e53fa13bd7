// What each part of a config costs per tick: as the reference table has it (daemon/cost_table.h),
// and as measured here and now. Needs no device and no rights; whatever compiles can be asked about.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "config/compile.h"
#include "daemon/cost_measure.h"

namespace hapticd::daemon {

struct CostOptions {
  std::size_t ticks = 20'000;  ///< per figure, shared out over kBatches batches
};

/// Nanoseconds per tick.
struct Cost {
  double predicted_ns = 0;
  std::optional<Figure> measured{};  ///< none: there is no way to measure it; `note` says why
  std::string note{};                ///< for people; empty: nothing to say
};

/// A part of the tick that is there whatever is touched.
struct StageCost {
  std::string name;
  Cost cost;
};

/// Objects of one kind: one of them, or the many that are not measured one by one.
struct ObjectCost {
  std::string kind;       ///< "sphere"
  std::string name{};     ///< empty: of several
  std::size_t count = 1;  ///< > 1: each of them costs this
  /// Not touched. What the broad phase holds back costs nothing then.
  Cost distant{};
  Cost touched{};
};

struct CostReport {
  double period_ns = 0;
  std::size_t ticks = 0;
  double floor_ns = 0;              ///< two runs of the same differ by so much
  std::vector<StageCost> stages{};  ///< loop, observers, coupling, broad phase
  std::vector<ObjectCost> objects{};
  Cost untouched{};            ///< of a tick in which nothing is touched
  Cost busiest{};              ///< of one in which the object that costs most is touched
  std::string busiest_name{};  ///< "sphere ball"; empty: nothing can be touched
};

/// Objects of a kind that get figures of their own; the rest is one row.
inline constexpr std::size_t kObjectsOfAKind = 50;

/// Takes as long as `options.ticks` ticks for each part and object, about two seconds for a
/// hundred.
CostReport cost(const config::Compiled& compiled, const CostOptions& options);

}  // namespace hapticd::daemon
