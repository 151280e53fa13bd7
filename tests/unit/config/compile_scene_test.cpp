// Objects of the scene to shapes, fields and encounters.
#include <cmath>
#include <limits>

#include "tests/unit/config/world_text.h"

namespace hapticd::config::test {
namespace {

using control::ObjectKind;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const std::string kAllCoupled =
    "coupling: {blocks: [{contacts: [ball, rod], stiffness_N_m: 100}]}\n";

build::ProgramSpec scene_of(const std::string& text) {
  const Compiled compiled = compiled_of(text);
  return compiled.program ? compiled.program->spec() : build::ProgramSpec{};
}

TEST(CompileScene, PlainPlaneOfAFreeContactIsAPlaneContact) {
  const auto spec = scene_of(with_object("plane: {name: a, normal: [2, 0, 0], stiffness_N_m: 9}"));
  EXPECT_EQ(spec.planes.size(), 2U);
  EXPECT_TRUE(spec.encounters.empty());
  EXPECT_TRUE(spec.contacts.empty()) << "nothing needs them";
}

TEST(CompileScene, ToolRadiusGoesIntoThePlanesOffset) {
  const std::string plane = "plane: {name: a, normal: [1, 0, 0], offset_m: 0.1, stiffness_N_m: 9}";
  const auto spec = scene_of(
      replaced(with_object(plane), "    latency_s", "    tool_radius_m: 0.02\n    latency_s"));
  EXPECT_DOUBLE_EQ(spec.planes.at(0).offset, 0.1);
  EXPECT_DOUBLE_EQ(spec.planes.at(1).offset, 0.12);
}

TEST(CompileScene, PlaneWithFrictionOrMotionOrRigidOrCoupledIsMet) {
  const auto is_met = [](const std::string& keys, const std::string& before) {
    const auto spec =
        scene_of(with_object("plane: {name: a, normal: [1, 0, 0], " + keys + "}", before));
    EXPECT_EQ(spec.planes.size() + spec.encounters.size(), 2U) << keys;
    return spec.encounters.size();
  };
  EXPECT_EQ(is_met("stiffness_N_m: 9", ""), 0U);
  EXPECT_EQ(is_met("stiffness_N_m: 9, friction: {static: 1, dynamic: 0.5}", ""), 2U);
  EXPECT_EQ(is_met("stiffness_N_m: 9, motion: {waypoints: [{at_s: 0}]}", ""), 2U);
  EXPECT_EQ(is_met("rigid: true", kAllCoupled), 2U);
  EXPECT_EQ(is_met("stiffness_N_m: 9", kAllCoupled), 2U);
  EXPECT_EQ(
      is_met("stiffness_N_m: 9", "coupling: {blocks: [{contacts: [rod], stiffness_N_m: 100}]}\n"),
      1U);
}

TEST(CompileScene, SurfaceIsStiffnessDampingAndFriction) {
  const auto spec = scene_of(with_object(
      "sphere: {name: a, radius_m: 0.1, stiffness_N_m: 500, damping_Ns_m: 2, friction: {static: "
      "0.7, dynamic: 0.4}}"));
  ASSERT_EQ(spec.encounters.size(), 2U);
  ASSERT_EQ(spec.spheres.size(), 1U) << "one shape for all who feel it";
  const control::Encounter& met = spec.encounters[1];
  EXPECT_EQ(met.kind, ObjectKind::sphere);
  EXPECT_EQ(met.contact, 1);
  EXPECT_EQ(met.shape, 0U);
  EXPECT_EQ(met.path, control::kNoPath);
  EXPECT_DOUBLE_EQ(met.surface.compliance, 0.002);
  EXPECT_EQ(met.surface.damping, 2);
  EXPECT_EQ(met.surface.static_friction, 0.7);
  EXPECT_EQ(met.surface.dynamic_friction, 0.4);
}

TEST(CompileScene, ContactsAreWhereDevicesStandInTheDirectionsTheyLack) {
  const auto spec =
      scene_of(replaced(with_object("sphere: {name: a, radius_m: 0.1, stiffness_N_m: 500}"),
                        "    latency_s", "    tool_radius_m: 0.02\n    latency_s"));
  ASSERT_EQ(spec.contacts.size(), 2U);
  EXPECT_EQ(spec.contacts[0].coordinates, 3);
  EXPECT_EQ(spec.contacts[0].fixed, (Vec3{0, 0, 0}));
  EXPECT_EQ(spec.contacts[0].direction, (std::array<std::uint8_t, 3>{0, 1, 2}));
  EXPECT_EQ(spec.contacts[0].max_force, 8);
  EXPECT_EQ(spec.contacts[1].device, 1);
  EXPECT_EQ(spec.contacts[1].first_coordinate, 3);
  EXPECT_EQ(spec.contacts[1].coordinates, 1);
  EXPECT_EQ(spec.contacts[1].fixed, (Vec3{0, 0.5, 0.25}));
  EXPECT_EQ(spec.contacts[1].radius, 0.02);
  EXPECT_EQ(spec.contacts[1].max_force, 4);
}

TEST(CompileScene, ShapesStandWhereTheKeysSay) {
  const auto spec = scene_of(
      kWorld +
      "scene:\n"
      "  - box: {name: a, center_m: [1, 2, 3], size_m: [2, 4, 6], free: inside, stiffness_N_m: 1,\n"
      "          rotation_quaternion: [0.7071067811865476, 0, 0, 0.7071067811865476]}\n"
      "  - cylinder: {name: b, axis: [0, 0, 5], radius_m: 1, length_m: 3, stiffness_N_m: 1}\n"
      "  - capsule: {name: c, axis: [0, 3, 4], radius_m: 1, length_m: 3, stiffness_N_m: 1}\n"
      "  - texture: {name: d, normal: [0, 0, 2], along: [1, 0, 7], amplitude_m: 0.1, wavelength_m: "
      "0.2,\n              profile: groove, offset_m: 4, stiffness_N_m: 1}\n");
  ASSERT_EQ(spec.boxes.size(), 1U);
  EXPECT_EQ(spec.boxes[0].half, (Vec3{1, 2, 3}));
  EXPECT_EQ(spec.boxes[0].free, control::Free::inside);
  EXPECT_EQ(to_world(spec.boxes[0].frame, {1, 0, 0}), (Vec3{1, 3, 3})) << "a quarter turn about z";
  EXPECT_EQ(spec.cylinders.at(0).axis, (Vec3{0, 0, 1}));
  EXPECT_EQ(spec.cylinders[0].half, 1.5);
  EXPECT_EQ(spec.capsules.at(0).axis, (Vec3{0, 0.6, 0.8}));
  EXPECT_EQ(spec.reliefs.at(0).along, (Vec3{1, 0, 0})) << "its part along the surface";
  EXPECT_EQ(spec.reliefs[0].profile, control::Relief::Profile::groove);
  EXPECT_EQ(spec.reliefs[0].offset, 4);
}

TEST(CompileScene, GuidesAndFieldsHaveNoEndUnlessItIsSaid) {
  const auto spec =
      scene_of(kWorld +
               "scene:\n"
               "  - point: {name: a, center_m: [1, 2, 3], stiffness_N_m: 4}\n"
               "  - line: {name: b, axis: [0, 2, 0], stiffness_N_m: 4, length_m: 6, range_m: 0.5}\n"
               "  - line: {name: c, axis: [0, 2, 0], stiffness_N_m: 4}\n"
               "  - curve: {name: d, points_m: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], closed: true, "
               "stiffness_N_m: 4}\n"
               "  - viscous: {name: e, damping_Ns_m: 3}\n"
               "  - constant: {name: f, force_N: [1, 2, 3], center_m: [4, 5, 6], radius_m: 7}\n"
               "  - detents: {name: g, along: [0, 3, 0], spacing_m: 0.1, max_force_N: 2, count: 5, "
               "offset_m: "
               "1}\n"
               "  - magnet: {name: h, range_m: 0.1, max_force_N: 2}\n"
               "  - vibration: {name: i, force_N: [0, 0, 1], frequency_Hz: 200, phase_rad: 1}\n");
  EXPECT_EQ(spec.point_guides.at(0).range, kInfinity);
  EXPECT_EQ(spec.line_guides.at(0).half, 3);
  EXPECT_EQ(spec.line_guides[0].range, 0.5);
  EXPECT_EQ(spec.line_guides.at(1).half, kInfinity);
  EXPECT_EQ(spec.curve_guides.at(0).count, 4U) << "the way back is a side too";
  EXPECT_EQ(spec.curve_points.back(), (Vec3{0, 0, 0}));
  EXPECT_EQ(spec.viscous_fields.at(0).region.radius, kInfinity);
  EXPECT_EQ(spec.constant_fields.at(0).region.centre, (Vec3{4, 5, 6}));
  EXPECT_EQ(spec.constant_fields[0].region.radius, 7);
  EXPECT_EQ(spec.detents.at(0).along, (Vec3{0, 1, 0}));
  EXPECT_EQ(spec.detents[0].count, 5U);
  EXPECT_EQ(spec.magnets.at(0).radius, 0);
  EXPECT_EQ(spec.vibrations.at(0).frequency, 200);
  ASSERT_EQ(spec.encounters.size(), 18U) << "nine objects, two contacts";
  EXPECT_DOUBLE_EQ(spec.encounters[0].surface.compliance, 0.25);
}

TEST(CompileScene, PathOfAMovingObjectIsItsWaypoints) {
  const auto spec = scene_of(with_object(
      "sphere: {name: a, radius_m: 0.1, stiffness_N_m: 500, devices: [rod], motion: {repeat: true, "
      "waypoints: [{at_s: 0}, {at_s: 2, position_m: [1, 0, 0]}, {at_s: 3}]}}"));
  ASSERT_EQ(spec.paths.size(), 1U);
  EXPECT_EQ(spec.paths[0].count, 3U);
  EXPECT_TRUE(spec.paths[0].repeat);
  EXPECT_EQ(spec.waypoints.at(1).at_s, 2);
  EXPECT_EQ(spec.waypoints[1].position, (Vec3{1, 0, 0}));
  ASSERT_EQ(spec.encounters.size(), 1U);
  EXPECT_EQ(spec.encounters[0].path, 0U);
  EXPECT_EQ(spec.encounters[0].contact, 1);
}

TEST(CompileScene, MeshIsReadOnceForEachPlace) {
  const std::string file = source_path("config/examples/ball.obj");
  const auto mesh = [&](const std::string& name, const std::string& more) {
    return "  - mesh: {name: " + name + ", file: " + file + ", scale: 0.001, stiffness_N_m: 1" +
           more + "}\n";
  };
  const auto spec = scene_of(kWorld + "scene:\n" + mesh("a", "") + mesh("b", ", devices: [rod]") +
                             mesh("c", ", position_m: [1, 0, 0]"));
  ASSERT_EQ(spec.meshes.size(), 2U);
  EXPECT_EQ(spec.meshes[0]->triangles.size(), 1280U);
  EXPECT_EQ(spec.encounters.size(), 5U);
  const auto centre_x = [](const build::MeshData& m) {
    return 0.5 * (m.bounds.min.x + m.bounds.max.x);
  };
  EXPECT_NEAR(centre_x(*spec.meshes[0]), 0, 1e-6);
  EXPECT_NEAR(centre_x(*spec.meshes[1]), 1, 1e-6);
  EXPECT_NEAR(spec.meshes[0]->bounds.max.z, 0.030, 1e-3) << "30 mm";
}

TEST(CompileScene, MeshThatCannotBeReadIsNamedWithItsFile) {
  expect_error(with_object("mesh: {name: a, file: none.obj, stiffness_N_m: 1}"), "15:27",
               "scene[0].mesh.file", {"none.obj"});
  expect_error(with_object("mesh: {name: a, file: '" + source_path("config/examples/ball.obj") +
                           "', max_triangles: 1279, stiffness_N_m: 1}"),
               "15:27", "scene[0].mesh.file", {"ball.obj", "1280"});
}

TEST(CompileScene, SurfaceIsStiffOrRigid) {
  expect_error(with_object("sphere: {name: a, radius_m: 1}"), "15:13", "scene[0].sphere",
               {"expected stiffness_N_m or rigid", "neither"});
  expect_error(
      with_object("sphere: {name: a, radius_m: 1, stiffness_N_m: 1, rigid: true}", kAllCoupled),
      "16:13", "scene[0].sphere", {"both"});
  expect_error(
      with_object("sphere: {name: a, radius_m: 1, rigid: true, damping_Ns_m: 1}", kAllCoupled),
      "16:63", "scene[0].sphere.damping_Ns_m", {"rigid"});
}

TEST(CompileScene, RigidNeedsACouplingOfAllCoordinates) {
  expect_error(
      with_object("sphere: {name: a, radius_m: 1, rigid: true, devices: [ball]}",
                  "coupling: {blocks: [{contacts: [ball.x, ball.z], stiffness_N_m: 1}]}\n"),
      "16:43", "scene[0].sphere.rigid", {"no block", "ball.y"});
}

TEST(CompileScene, FrictionAtRestIsTheLargerOne) {
  expect_error(with_object("sphere: {name: a, radius_m: 1, stiffness_N_m: 1, friction: {static: "
                           "0.3, dynamic: 0.4}}"),
               "15:73", "scene[0].sphere.friction.static", {"at least", "0.4", "found 0.3"});
}

TEST(CompileScene, MotionIsInTheOrderOfTimeFromZero) {
  const auto with = [](const std::string& waypoints) {
    return with_object("sphere: {name: a, radius_m: 1, stiffness_N_m: 1, motion: {waypoints: [" +
                       waypoints + "], repeat: true}}");
  };
  expect_error(with("{at_s: 1}, {at_s: 2}"), "15:82", "scene[0].sphere.motion.waypoints[0].at_s",
               {"expected 0", "found 1 s"});
  expect_error(with("{at_s: 0}, {at_s: 0}"), "15:93", "scene[0].sphere.motion.waypoints[1].at_s",
               {"more than 0 s"});
  expect_error(with("{at_s: 0}, {at_s: 1, position_m: [1, 0, 0]}"), "15:86",
               "scene[0].sphere.motion.waypoints[1]", {"jump"});
  expect_error(with("{at_s: 0}"), "15:95", "scene[0].sphere.motion.repeat", {"one waypoint"});
}

TEST(CompileScene, ToolHasToFitInside) {
  const std::string inside = with_object(
      "box: {name: a, size_m: [1, 1, 0.04], free: inside, stiffness_N_m: 1, devices: [rod]}");
  const auto radius = [&](const std::string& r) {
    return replaced(inside, "    latency_s", "    tool_radius_m: " + r + "\n    latency_s");
  };
  EXPECT_TRUE(errors_of(radius("0.019")).empty());
  expect_error(radius("0.02"), "16:48", "scene[0].box.free", {"'rod'", "0.02 m", "no room"});
}

TEST(CompileScene, WhatPointsNowhereIsRefused) {
  for (const char* object :
       {"line: {name: a, axis: [0, 0, 0], stiffness_N_m: 1}",
        "detents: {name: a, along: [0, 0, 0], spacing_m: 1, max_force_N: 1}",
        "cylinder: {name: a, axis: [0, 0, 0], radius_m: 1, length_m: 1, stiffness_N_m: 1}"}) {
    const auto errors = errors_of(with_object(object));
    ASSERT_EQ(errors.size(), 1U) << object << listed(errors);
    EXPECT_NE(errors[0].message.find("length 0"), std::string::npos) << errors[0].message;
  }
  expect_error(
      with_object("texture: {name: a, normal: [0, 0, 1], along: [0, 0, 2], amplitude_m: 1, "
                  "wavelength_m: 1, stiffness_N_m: 1}"),
      "15:50", "scene[0].texture.along", {"along the surface"});
}

TEST(CompileScene, CornersOfACurveDiffer) {
  expect_error(with_object("curve: {name: a, stiffness_N_m: 1, points_m: [[0, 0, 0], [0, 0, 0]]}"),
               "15:62", "scene[0].curve.points_m[1]", {"where the one before is"});
  expect_error(with_object("curve: {name: a, stiffness_N_m: 1, closed: true, points_m: [[0, 0, 0], "
                           "[1, 0, 0], [0, 0, 0]]}"),
               "15:87", "scene[0].curve.points_m[2]", {"closed"});
}

TEST(CompileScene, VibrationIsSlowerThanTheLoopCanFollow) {
  expect_error(with_object("vibration: {name: a, force_N: [1, 0, 0], frequency_Hz: 500}"), "15:60",
               "scene[0].vibration.frequency_Hz", {"less than half", "500 Hz"});
}

TEST(CompileScene, AssumptionsNameObjects) {
  const auto assumed = [](const std::string& text) { return compiled_of(text).assumed.at(0); };
  const auto plain = assumed(with_object("sphere: {name: hill, radius_m: 1, stiffness_N_m: 1}"));
  EXPECT_TRUE(plain.active.empty());
  EXPECT_EQ(plain.nonconvex, (std::vector<std::string>{"sphere 'hill'"}));
  const auto moving =
      assumed(with_object("sphere: {name: hill, radius_m: 1, stiffness_N_m: 1, motion: "
                          "{waypoints: [{at_s: 0}]}}"));
  ASSERT_EQ(moving.active.size(), 1U);
  EXPECT_EQ(moving.active[0].object, "sphere 'hill'");
  EXPECT_EQ(moving.active[0].reason.find("moves"), 0U);
  const auto driven =
      assumed(with_object("vibration: {name: hum, force_N: [1, 0, 0], frequency_Hz: 50}"));
  ASSERT_EQ(driven.active.size(), 1U);
  EXPECT_EQ(driven.active[0].object, "vibration 'hum'");
  const std::string mass =
      "\n  - network: {name: n, nodes: [{name: m, mass_kg: 1}], elements: [{between: [ball.x, m], "
      "stiffness_N_m: 1}]}";
  const std::string hill = "sphere: {name: hill, radius_m: 1, stiffness_N_m: 1, free: ";
  EXPECT_TRUE(assumed(with_object(hill + "outside}" + mass)).heavy_network);
  EXPECT_TRUE(assumed(with_object(hill + "inside}" + mass)).nonconvex.empty());
  EXPECT_FALSE(plain.heavy_network);
}

}  // namespace
}  // namespace hapticd::config::test
