#include "daemon/telemetry.h"

#include <sys/resource.h>

#include <csignal>
#include <mutex>
#include <thread>

#include "tests/unit/daemon/recording_fixture.h"

namespace hapticd::daemon {
namespace {

using namespace std::chrono_literals;

class TelemetryTest : public RecordingTest {
 protected:
  TelemetryTest() : words_(kSlots * program_.plan().record.bytes / 8) {}

  void start(TelemetryOptions options) {
    telemetry_.emplace(std::move(options), header(), ring_,
                       TelemetryEvents{[this](const std::string& file, std::uint64_t n) {
                                         const std::lock_guard lock(mutex_);
                                         flights_.emplace_back(file, n);
                                       },
                                       [this](const Error& error) {
                                         const std::lock_guard lock(mutex_);
                                         errors_.push_back(error.text);
                                       }});
    const auto started = telemetry_->start();
    ASSERT_TRUE(started) << started.error().text;
  }
  /// Ticks `from` to `to` - 1 as a servo thread would hand them over, but never faster than they
  /// are taken.
  void run(std::uint32_t from, std::uint32_t to, Fault fault = Fault::none) {
    for (std::uint32_t i = from; i < to; ++i) {
      std::byte* slot = wait_for_slot();
      ASSERT_NE(slot, nullptr);
      std::memcpy(slot, record(i, fault).data(), ring_.slot_bytes());
      ring_.commit();
    }
  }
  std::byte* wait_for_slot() {
    for (int i = 0; i < 10'000; ++i) {
      if (std::byte* slot = ring_.reserve()) return slot;
      std::this_thread::sleep_for(1ms);
    }
    return nullptr;
  }
  template <class Done>
  void wait_until(Done done) {
    for (int i = 0; i < 10'000; ++i) {
      {
        const std::lock_guard lock(mutex_);
        if (done()) return;
      }
      std::this_thread::sleep_for(1ms);
    }
    FAIL() << "waited 10 s in vain";
  }
  static std::vector<double> ticks(const std::string& file) {
    std::vector<double> values;
    auto read = read_recording(file);
    EXPECT_TRUE(read) << read.error().text;
    if (!read) return values;
    for (std::size_t i = 0; i < read->size(); ++i)
      values.push_back(read->value(i, *read->find("tick")));
    return values;
  }

  static constexpr std::size_t kSlots = 256;
  std::vector<std::uint64_t> words_;
  rt::SpscRing ring_{std::as_writable_bytes(std::span(words_)), program_.plan().record.bytes};
  std::optional<Telemetry> telemetry_;
  std::mutex mutex_;
  std::vector<std::pair<std::string, std::uint64_t>> flights_;
  std::vector<std::string> errors_;
};

TEST_F(TelemetryTest, AFaultWritesTheSecondsAroundIt) {
  start({.flight_dir = path("flights"), .flight_s = 0.5, .after_s = 0.1, .record_path = {}});
  run(0, 3000);
  run(3000, 3400, Fault::overrun);
  wait_until([&] { return !flights_.empty(); });
  telemetry_->stop();
  ASSERT_EQ(flights_.size(), 1u) << "the fault that stands is told once";
  const std::string file = flights_[0].first;
  EXPECT_EQ(file.find(path("flights") + "/flight-"), 0u) << file;
  EXPECT_NE(file.find("Z-overrun.hapticrec"), std::string::npos) << file;
  const std::vector<double> seen = ticks(file);
  EXPECT_EQ(seen.size(), flights_[0].second);
  ASSERT_FALSE(seen.empty());
  EXPECT_EQ(seen.front(), 2500);
  EXPECT_EQ(seen.back(), 3100);
  EXPECT_EQ(seen.size(), 601u);
  EXPECT_EQ(telemetry_->lost(), 0u);
  EXPECT_TRUE(errors_.empty());
}

TEST_F(TelemetryTest, AFaultInTheFirstTickHasNothingBeforeIt) {
  start({.flight_dir = path("flights"), .flight_s = 0.5, .after_s = 0.01, .record_path = {}});
  run(0, 5, Fault::device);
  telemetry_->stop();
  ASSERT_EQ(flights_.size(), 1u) << "stop finishes a file that is under way";
  EXPECT_EQ(ticks(flights_[0].first), (std::vector<double>{0, 1, 2, 3, 4}));
}

TEST_F(TelemetryTest, EveryFaultHasItsOwnFileAndNoneIsOverwritten) {
  start({.flight_dir = path("flights"), .flight_s = 0.02, .after_s = 0.005, .record_path = {}});
  for (std::uint32_t k = 0; k < 3; ++k) {
    run(100 * k, 100 * k + 50);
    run(100 * k + 50, 100 * k + 100, Fault::estop);
    wait_until([&] { return flights_.size() == k + 1; });
  }
  telemetry_->stop();
  ASSERT_EQ(flights_.size(), 3u);
  for (std::uint32_t k = 0; k < 3; ++k) EXPECT_EQ(ticks(flights_[k].first).back(), 100 * k + 55);
}

TEST_F(TelemetryTest, AFullRecordingHoldsEveryRecord) {
  start({.flight_dir = {}, .record_path = path("all.hapticrec")});
  run(0, 5000);
  telemetry_->stop();
  const std::vector<double> seen = ticks(path("all.hapticrec"));
  ASSERT_EQ(seen.size(), 5000u);
  for (std::size_t i = 0; i < seen.size(); ++i) ASSERT_EQ(seen[i], static_cast<double>(i));
}

TEST_F(TelemetryTest, AFullRecordingThatExistsIsLeftAlone) {
  spill(path("all.hapticrec"), "yesterday's");
  start({.flight_dir = {}, .record_path = path("all.hapticrec")});
  run(0, 10);
  telemetry_->stop();
  EXPECT_EQ(slurp(path("all.hapticrec")), "yesterday's");
  std::size_t files = 0;
  for (const auto& file : std::filesystem::directory_iterator(dir_)) {
    const std::string name = file.path().filename();
    if (name == "all.hapticrec") continue;
    EXPECT_TRUE(name.starts_with("all-20") && name.ends_with("Z.hapticrec")) << name;
    EXPECT_EQ(ticks(file.path()).size(), 10u);
    ++files;
  }
  EXPECT_EQ(files, 1u);
}

TEST_F(TelemetryTest, AReloadGoesOnInAFileWithTheNewConfig) {
  start({.flight_dir = {}, .record_path = path("all.hapticrec")});
  run(0, 100);
  wait_until([&] { return true; });
  RecordingHeader next = header();
  next.config_text = "version: 1 # reloaded\n";
  telemetry_->set_header(next);
  wait_until([&] { return std::distance(std::filesystem::directory_iterator(dir_), {}) == 2; });
  run(100, 200);
  telemetry_->stop();
  std::size_t records = 0;
  for (const auto& file : std::filesystem::directory_iterator(dir_)) {
    auto read = read_recording(file.path());
    ASSERT_TRUE(read) << read.error().text;
    records += read->size();
    const bool first = file.path().filename() == "all.hapticrec";
    EXPECT_EQ(read->header.config_text, first ? "version: 1\n" : next.config_text);
  }
  EXPECT_EQ(records, 200u) << "no record is lost between the files";
}

TEST_F(TelemetryTest, GapsInTheSequenceAreCountedAsLost) {
  start({.flight_dir = {}, .record_path = {}});
  run(0, 10);
  run(15, 20);
  run(21, 22);
  telemetry_->stop();
  EXPECT_EQ(telemetry_->lost(), 6u);
}

TEST_F(TelemetryTest, AStalledReaderCostsDropsThatAreCountedAndNeverTheWriter) {
  // Not started yet: nobody reads.
  for (std::uint32_t i = 0; i < kSlots + 40; ++i) {
    if (std::byte* slot = ring_.reserve()) {
      std::memcpy(slot, record(i).data(), ring_.slot_bytes());
      ring_.commit();
    }
  }
  EXPECT_EQ(ring_.dropped(), 40u);
  start({.flight_dir = {}, .record_path = path("all.hapticrec")});
  run(kSlots + 40, kSlots + 50);
  telemetry_->stop();
  EXPECT_EQ(telemetry_->lost(), 40u) << "the file's gap is what the ring dropped";
  EXPECT_EQ(ticks(path("all.hapticrec")).size(), kSlots + 10);
}

TEST_F(TelemetryTest, AFullDiskIsToldOnceAndTheRestGoesOn) {
  std::signal(SIGXFSZ, SIG_DFL);  // the telemetry thread must not die of it either
  start({.flight_dir = path("flights"),
         .flight_s = 0.02,
         .after_s = 0.005,
         .record_path = path("all.hapticrec")});
  struct rlimit before {};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const struct rlimit small { 200'000, before.rlim_max };
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  run(0, 3000);
  run(3000, 3100, Fault::overrun);
  wait_until([&] { return !flights_.empty(); });
  telemetry_->stop();
  ::setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_EQ(errors_.size(), 1u);
  EXPECT_NE(errors_[0].find("File too large"), std::string::npos) << errors_[0];
  const std::vector<double> seen = ticks(path("all.hapticrec"));
  EXPECT_GT(seen.size(), 100u);
  EXPECT_NE(errors_[0].find("the " + std::to_string(seen.size()) + " whole records"),
            std::string::npos)
      << errors_[0];
  EXPECT_EQ(ticks(flights_[0].first).size(), 26u) << "the flight recorder has a file of its own";
}

TEST_F(TelemetryTest, AFlightDirectoryThatCannotBeMadeIsToldOncePerFault) {
  start({.flight_dir = path("no/such/parent"),
         .flight_s = 0.02,
         .after_s = 0.005,
         .record_path = {}});
  run(0, 50);
  run(50, 100, Fault::overrun);
  telemetry_->stop();
  ASSERT_EQ(errors_.size(), 1u);
  EXPECT_NE(errors_[0].find("no/such/parent"), std::string::npos) << errors_[0];
  EXPECT_TRUE(flights_.empty());
}

TEST_F(TelemetryTest, FullFlightDirectoryKeepsWhatItHasAndSaysWhatToDo) {
  std::filesystem::create_directory(path("flights"));
  for (std::size_t i = 0; i < kMaxFlightFiles; ++i) {
    spill(path("flights") + "/flight-" + std::to_string(i) + ".hapticrec", "old");
  }
  start({.flight_dir = path("flights"), .flight_s = 0.02, .after_s = 0.005, .record_path = {}});
  run(0, 10, Fault::overrun);
  telemetry_->stop();
  ASSERT_EQ(errors_.size(), 1u);
  EXPECT_NE(errors_[0].find("move them away or delete them"), std::string::npos) << errors_[0];
  EXPECT_EQ(slurp(path("flights") + "/flight-0.hapticrec"), "old");
}

TEST_F(TelemetryTest, StartFailsWhereTheFullRecordingCannotBeCreated) {
  Telemetry telemetry({.flight_dir = {}, .record_path = path("no/such/file")}, header(), ring_, {});
  const auto started = telemetry.start();
  ASSERT_FALSE(started);
  EXPECT_NE(started.error().text.find("no/such/file"), std::string::npos);
}

TEST_F(TelemetryTest, HistorySurvivesManyTimesItsLength) {
  start({.flight_dir = path("flights"), .flight_s = 0.1, .after_s = 0, .record_path = {}});
  run(0, 20'000);
  run(20'000, 20'001, Fault::velocity);
  telemetry_->stop();
  ASSERT_EQ(flights_.size(), 1u);
  const std::vector<double> seen = ticks(flights_[0].first);
  ASSERT_EQ(seen.size(), 101u);
  for (std::size_t i = 0; i < seen.size(); ++i) ASSERT_EQ(seen[i], 19'900 + static_cast<double>(i));
}

}  // namespace
}  // namespace hapticd::daemon
