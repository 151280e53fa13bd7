// What the reference machine would take, from the table (daemon/cost_table.h).
#pragma once
#include <string>

#include "control/build/program.h"

namespace hapticd::daemon {

double predicted_loop_ns(const build::ProgramSpec& spec);
double predicted_observers_ns(const build::ProgramSpec& spec);
/// Contacts, coupling and networks.
double predicted_coupling_ns(const control::Plan& plan);
double predicted_broad_phase_ns(const control::Plan& plan);
/// The object of a program that has no other: all contacts that meet it, far away.
double predicted_distant_ns(const std::string& kind, const control::Plan& plan);
/// The same with contact of one of them.
double predicted_touched_ns(const std::string& kind, const control::Plan& plan);

}  // namespace hapticd::daemon
