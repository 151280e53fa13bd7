// The certificate of a designed coupling: its matrices, and whether the config in force is what it
// was designed for. What differs makes the certificate count for nothing; the closed forms are
// still tried.
#include <memory>
#include <string>

#include "config/compilation.h"
#include "config/digest.h"
#include "config/matrices.h"
#include "config/number.h"
#include "config/write_yaml.h"
#include "control/design/check/certificate.h"

namespace hapticd::config {
namespace {

check::Certificate certificate_of(const CouplingCertificate& written) {
  return {.kind = written.kind,
          .damping_share = written.damping_share,
          .P_scene = as_matrix(written.P_scene),
          .Phi_scene = as_matrix(written.Phi_scene),
          .P_coupling = as_matrix(written.P_coupling),
          .Delta_coupling = as_matrix(written.Delta_coupling),
          .P = as_matrix(written.P)};
}

std::string differs(const std::string& what, const std::string& designed,
                    const std::string& found) {
  return what + " was " + designed + " when it was designed and is " + found + " now";
}

/// Of one device, what is worse now than when the coupling was designed; empty: nothing.
std::string worse(const AssumedDevice& designed, const AssumedDevice& now) {
  if (now.name != designed.name) return differs("a device", designed.name, now.name);
  if (now.latency_s > designed.latency_s) {
    return differs(now.name + ".latency_s", format_number(designed.latency_s),
                   format_number(now.latency_s));
  }
  if (now.min_damping.size() != designed.min_damping.size())
    return "device " + now.name + " has another number of axes, or no model";
  for (std::size_t i = 0; i < now.min_damping.size(); ++i) {
    if (!(now.min_damping[i] >= designed.min_damping[i])) {
      return differs("the least damping of axis " + std::to_string(i) + " of " + now.name,
                     format_number(designed.min_damping[i]), format_number(now.min_damping[i]));
    }
  }
  if (now.estimators != designed.estimators)
    return "the velocity estimators of " + now.name + " are others";
  if (now.observers != designed.observers) return "the observers of " + now.name + " are others";
  return {};
}

std::string worse(const Assumed& designed, const Assumed& now, check::CertificateKind kind) {
  if (now.rate_Hz != designed.rate_Hz) {
    return differs("loop.rate_Hz", format_number(designed.rate_Hz), format_number(now.rate_Hz));
  }
  if (kind != check::CertificateKind::passive_closed_form && now.scene != designed.scene)
    return "the scene is another, and this certificate is about the one that it was designed for";
  if (now.devices.size() != designed.devices.size()) return "the number of devices is another";
  for (std::size_t i = 0; i < now.devices.size(); ++i) {
    std::string text = worse(designed.devices[i], now.devices[i]);
    if (!text.empty()) return text;
  }
  return {};
}

std::string problem(const DesignedCoupling& designed, const Assumed& now) {
  if (!designed.certificate || !designed.assumed || designed.digest.empty()) {
    return "one of its keys certificate, assumed and digest is missing; a designed coupling has "
           "all three";
  }
  if (designed.digest != designed.actual_digest) {
    return "it was changed after it was designed: its digest is " + designed.actual_digest +
           ", written in it is " + designed.digest +
           "; design it again, or remove certificate, assumed and digest";
  }
  const std::string text = worse(*designed.assumed, now, designed.certificate->kind);
  return text.empty() ? text : text + "; design it again for this config";
}

}  // namespace

Assumed assumptions(const Compiled& compiled) {
  const Config& config = compiled.document.config;
  Assumed assumed{.rate_Hz = config.loop.rate_Hz, .scene = digest_of(to_yaml(config.scene))};
  for (std::size_t i = 0; i < config.devices.size(); ++i) {
    AssumedDevice device{.name = config.devices[i].name,
                         .latency_s = compiled.assumed[i].latency_s,
                         .min_damping = compiled.assumed[i].min_damping};
    for (const Axis& axis : config.devices[i].axes) {
      device.estimators.push_back(axis.velocity.estimator);
      device.observers.push_back(axis.observer.mode);
    }
    assumed.devices.push_back(std::move(device));
  }
  return assumed;
}

void compile_certificate(Compiled& compiled) {
  const std::optional<DesignedCoupling>& designed = compiled.document.designed;
  if (!designed) return;
  const std::string text = problem(*designed, assumptions(compiled));
  if (text.empty()) {
    compiled.certificate =
        std::make_shared<const check::Certificate>(certificate_of(*designed->certificate));
  } else {
    compiled.certificate_problem = "the certificate of " +
                                   *compiled.document.config.coupling->file +
                                   " does not count: " + text;
  }
}

}  // namespace hapticd::config
