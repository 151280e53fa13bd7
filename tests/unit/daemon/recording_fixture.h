// A small program, records of it, and a folder of its own for each test.
#pragma once
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "control/build/program.h"
#include "control/record.h"
#include "daemon/recording.h"

namespace hapticd::daemon {

/// Two devices: "left" with axes x and y, "right" with x.
inline build::ProgramSpec two_devices() {
  build::ProgramSpec spec;
  spec.axes.resize(3);
  spec.devices = {{.first_axis = 0, .axes = 2, .first_coordinate = 0, .coordinates = 2},
                  {.first_axis = 2, .axes = 1, .first_coordinate = 2, .coordinates = 1}};
  spec.device_names = {"left", "right"};
  spec.axis_names = {"left.x", "left.y", "right.x"};
  spec.coordinate_names = spec.axis_names;
  return spec;
}

class RecordingTest : public ::testing::Test {
 protected:
  RecordingTest() {
    std::string name = (std::filesystem::temp_directory_path() / "hapticd-test-XXXXXX").string();
    dir_ = ::mkdtemp(name.data()) == nullptr ? "." : name;
  }
  ~RecordingTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(dir_, ignored);
  }

  std::string path(const std::string& name) const { return (dir_ / name).string(); }
  RecordingHeader header() const {
    return recording_header(program_, "0123456789abcdef", "version: 1\n");
  }

  /// The record of a tick: sequence and tick are `i`, every other byte is zero.
  std::vector<std::byte> record(std::uint32_t i, Fault fault = Fault::none) const {
    control::RecordHeader head;
    head.tick = i;
    head.sequence = i;
    head.fault = fault;
    std::vector<std::byte> bytes(program_.plan().record.bytes);
    std::memcpy(bytes.data(), &head, sizeof head);
    return bytes;
  }

  void write_records(const std::string& file, std::uint32_t n) const {
    auto writer = RecordingWriter::create(file, header());
    ASSERT_TRUE(writer) << writer.error().text;
    for (std::uint32_t i = 0; i < n; ++i) ASSERT_TRUE(writer->append(record(i).data()));
    ASSERT_TRUE(writer->close());
  }

  static std::string slurp(const std::string& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
  }
  static void spill(const std::string& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
  }

  std::filesystem::path dir_;
  build::Program program_{two_devices()};
};

}  // namespace hapticd::daemon
