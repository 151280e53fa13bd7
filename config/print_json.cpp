#include <nlohmann/json.hpp>
#include <variant>

#include "config/compile_usb.h"
#include "config/describe.h"
#include "config/effective_guard.h"
#include "config/field_traits.h"
#include "config/print.h"
#include "config/print_world.h"

namespace hapticd::config {
namespace {

using Json = nlohmann::ordered_json;

template <class T>
Json or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// "max_force_N" or "max_torque_Nm": the same figure in the axis' own units.
const char* key(bool rotary, const char* linear_key, const char* rotary_key) {
  return rotary ? rotary_key : linear_key;
}

Json model_json(const std::optional<AxisModel>& model, bool rotary) {
  if (!model) return nullptr;
  return {{key(rotary, "mass_kg", "inertia_kgm2"),
           or_null(rotary ? model->inertia_kgm2 : model->mass_kg)},
          {key(rotary, "damping_Ns_m", "damping_Nms_rad"),
           or_null(rotary ? model->damping_Nms_rad : model->damping_Ns_m)},
          {"mass_uncertainty", model->mass_uncertainty},
          {"damping_uncertainty", model->damping_uncertainty}};
}

/// `direction`: of a Cartesian device, else null.
Json axis_json(const Axis& axis, const control::AxisPlan& plan, const Json& direction) {
  const bool rotary = axis.kind == AxisKind::rotary;
  return {{"name", axis.name},
          {"kind", word_of(axis.kind)},
          {"direction", direction},
          {key(rotary, "m_per_count", "rad_per_count"), plan.unit_per_raw},
          {key(rotary, "offset_m", "offset_rad"), plan.offset},
          {"modulus_counts", plan.modulus_raw},
          {key(rotary, "max_force_N", "max_torque_Nm"), plan.max_effort},
          {"stuck_s", or_null(axis.encoder.stuck_s)},
          {"velocity", word_of(axis.velocity.estimator)},
          {"observer", word_of(axis.observer.mode)},
          {"homing", word_of(axis.homing.by)},
          {"model", model_json(axis.model, rotary)}};
}

Json guard_json(const EffectiveGuard& guard) {
  return {{"max_force_N", guard.max_force_N},
          {"max_velocity_m_s", guard.max_velocity_m_s},
          {"max_velocity_rad_s", guard.max_velocity_rad_s},
          {"max_slew_N_s", guard.max_slew_N_s},
          {"ramp_s", guard.ramp_s},
          {"max_stale_ticks", guard.max_stale_ticks},
          {"max_power_W", or_null(guard.max_power_W)}};
}

Json assumed_json(const check::DeviceAssumption& assumed, bool rotary) {
  std::vector<std::string> active;
  for (const check::ObjectNote& note : assumed.active)
    active.push_back(note.object + " " + note.reason);
  return {{"latency_s", assumed.latency_s},
          {key(rotary, "min_damping_Ns_m", "min_damping_Nms_rad"), assumed.min_damping},
          {"obstacles", assumed.obstacles},
          {"active", active},
          {"nonconvex", assumed.nonconvex}};
}

Json selection_json(const usb::Selection& selection) {
  const auto or_any = [](const std::string& text) {
    return text.empty() ? Json(nullptr) : Json(text);
  };
  Json usage = nullptr;
  if (selection.usage) usage = hex_pair_text(*selection.usage >> 16, *selection.usage & 0xffff);
  return {{"id", hex_pair_text(selection.vendor, selection.product)},
          {"serial", or_any(selection.serial)},
          {"path", or_any(selection.path)},
          {"interface", or_null(selection.interface)},
          {"usage", usage},
          {"transport", word_of(static_cast<UsbTransport>(selection.transport))},
          {"reads", selection.reads}};
}

/// null: not on USB.
Json usb_json(const Compiled& compiled, std::size_t index) {
  const auto& usb = compiled.usb[index];
  if (!usb) return nullptr;
  Json json = selection_json(usb->selection);
  json.update({{"arrival_age_s", usb->arrival_age_s},
               {"max_age_s", usb->worst_sample_age_s},
               {"send_s", usb->send_s},
               {"drive_delay_s", usb->drive_delay_s},
               {"watchdog_s", usb->watchdog_s},
               {"silence_s", usb->silence_s},
               {"least_latency_s", least_latency_s(*usb, waits_s(compiled))}});
  return json;
}

Json device_json(const Compiled& compiled, std::size_t index) {
  const Config& config = compiled.document.config;
  const Device& device = config.devices[index];
  const control::Plan& plan = compiled.program->plan();
  const std::size_t first_axis = plan.devices[index].first_axis;
  Json axes = Json::array();
  const auto* cartesian = std::get_if<Cartesian>(&device.kinematics);
  for (std::size_t i = 0; i < device.axes.size(); ++i) {
    const Json direction = cartesian ? Json(word_of(cartesian->directions[i])) : Json(nullptr);
    axes.push_back(axis_json(device.axes[i], plan.axes[first_axis + i], direction));
  }
  const auto kind = [](const auto& of) { return kKindOf<std::decay_t<decltype(of)>>; };
  const bool rotary = device.axes.front().kind == AxisKind::rotary;
  return {{"name", device.name},
          {"driver", word_of(device.driver)},
          {"kinematics", std::visit(kind, device.kinematics)},
          {"axes", axes},
          {"usb", usb_json(compiled, index)},
          {"guard", guard_json(effective_guard(config.guard, device))},
          {"assumed", assumed_json(compiled.assumed[index], rotary)}};
}

template <class T>
Json json_of(const T& value);

/// The visitor of config/describe.h that writes every key of a struct.
class JsonValues {
 public:
  template <class T>
  void required(const char* name, T& field, const Key&) {
    values[name] = json_of(field);
  }
  template <class T>
  void optional(const char* name, T& field, const Key&) {
    values[name] = json_of(field);
  }
  Json values = Json::object();
};

template <class T>
Json json_of(const T& value) {
  if constexpr (kIsOptional<T>) {
    return value ? json_of(*value) : Json(nullptr);
  } else if constexpr (std::is_enum_v<T>) {
    return word_of(value);
  } else if constexpr (kIsGains<T>) {
    return std::visit([](const auto& form) { return Json(form); }, value.value);
  } else if constexpr (kIsVector<T>) {
    Json list = Json::array();
    for (const auto& item : value) list.push_back(json_of(item));
    return list;
  } else if constexpr (kIsStruct<T>) {
    JsonValues writer;
    T copy = value;
    describe(writer, copy);
    return std::move(writer.values);
  } else {
    return value;
  }
}

/// Its keys as in a config; who feels it is said whether somebody wrote it or not.
template <class Kind>
Json object_json(const Config& config, const Kind& object) {
  Json json = {{"kind", kKindOf<Kind>}};
  json.update(json_of(object));
  if constexpr (!std::is_same_v<Kind, Network>) json["devices"] = felt_by(config, object);
  return json;
}

Json loop_json(const Config& config) {
  const Loop& loop = config.loop;
  return {{"rate_Hz", loop.rate_Hz},
          {"priority", loop.priority},
          {"cpu", or_null(loop.cpu)},
          {"max_gap_ticks", loop.max_gap_ticks},
          {"max_missed_per_s", loop.max_missed_per_s}};
}

}  // namespace

namespace {

Json buses_json(const Compiled& compiled) {
  Json buses = Json::array();
  for (const can::BusLoad& bus : compiled.buses) {
    buses.push_back({{"interface", bus.interface},
                     {"load", bus.share},
                     {"most_load", can::kMostLoad},
                     {"busiest_tick_s", bus.busiest_s},
                     {"axes", bus.axes},
                     {"axes_that_fit", bus.axes_that_fit}});
  }
  return buses;
}

}  // namespace

std::string plan_json(const Compiled& compiled) {
  const Document& document = compiled.document;
  const Config& config = document.config;
  Json devices = Json::array();
  for (std::size_t i = 0; i < config.devices.size(); ++i)
    devices.push_back(device_json(compiled, i));
  Json scene = Json::array();
  for (const SceneObject& object : config.scene) {
    scene.push_back(
        std::visit([&](const auto& shape) { return object_json(config, shape); }, object));
  }
  const Json json = {{"config", document.path},
                     {"digest", document.digest},
                     {"loop", loop_json(config)},
                     {"start", word_of(config.start.enable)},
                     {"require", word_of(config.stability.require)},
                     {"devices", devices},
                     {"buses", buses_json(compiled)},
                     {"coupling", json_of(config.coupling)},
                     {"scene", scene},
                     {"socket", config.control.socket},
                     {"flight_dir", config.telemetry.flight_dir},
                     {"flight_s", config.telemetry.flight_s},
                     {"record", or_null(config.telemetry.record)}};
  // A path may hold any bytes; JSON text may not.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace hapticd::config
