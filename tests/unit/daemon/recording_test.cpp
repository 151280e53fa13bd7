#include "daemon/recording.h"

#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <limits>
#include <set>

#include "control/core/sample.h"
#include "tests/unit/daemon/recording_fixture.h"

namespace hapticd::daemon {
namespace {

using Reading = RecordingTest;

TEST_F(RecordingTest, EveryByteOfARecordIsOfAtMostOneField) {
  const RecordingHeader made = header();
  std::vector<int> owners(made.record_bytes);
  for (const Field& field : made.fields) {
    for (std::size_t i = 0; i < field_bytes(field.type); ++i) ++owners.at(field.offset + i);
  }
  for (std::size_t i = 0; i < owners.size(); ++i) EXPECT_LE(owners[i], 1) << "byte " << i;
  EXPECT_EQ(header_defect(made), "");
}

TEST_F(RecordingTest, FieldsAreWhereTheLoopWritesThem) {
  std::vector<AxisSample> samples(3);
  std::vector<Aux> aux(2);
  std::vector<double> delivered = {4, 5, 6};
  samples[2] = {.raw = 7.5, .age_ns = 123, .freshness = Freshness::fresh};
  aux[1].digital = 0xdeadbeef;
  aux[1].armed = true;
  aux[1].analogue[5] = -1.25;
  program_.state().qd[1] = 0.125;
  program_.state().x[2] = 0.5;
  program_.state().force[0] = -9;
  program_.state().effort[1] = 2;
  control::TickInput input;
  input.tick = 42;
  input.axes = samples;
  input.aux = aux;
  input.delivered = delivered;
  input.host_fault = {.code = Fault::overrun};
  control::TickOutput output;
  output.mode = control::Mode::enabled;
  Recording recording{.header = header(), .data = {}};
  recording.data.resize(recording.header.record_bytes);
  control::write_record(program_.plan(), program_.state(), input, output, 1'000'000,
                        {.step_ns = -3}, 77, recording.data.data());
  const auto value = [&](const char* name) {
    const Field* field = recording.find(name);
    EXPECT_NE(field, nullptr) << name;
    return field == nullptr ? std::nan("") : recording.value(0, *field);
  };
  EXPECT_EQ(value("tick"), 42);
  EXPECT_EQ(value("time_ns"), 1e6);
  EXPECT_EQ(value("sequence"), 77);
  EXPECT_EQ(value("step_ns"), -3);
  EXPECT_EQ(value("mode"), 1);
  EXPECT_EQ(value("host_fault"), static_cast<double>(Fault::overrun));
  EXPECT_EQ(value("fault_axis"), 0xffff);
  EXPECT_EQ(value("right.x.raw"), 7.5);
  EXPECT_EQ(value("right.x.age_ns"), 123);
  EXPECT_EQ(value("right.x.freshness"), 2);
  EXPECT_EQ(value("left.y.qd"), 0.125);
  EXPECT_EQ(value("right.x.position"), 0.5);
  EXPECT_EQ(value("left.x.force"), -9);
  EXPECT_EQ(value("left.y.effort"), 2);
  EXPECT_EQ(value("right.x.delivered"), 6);
  EXPECT_EQ(value("right.digital"), 3735928559.0);
  EXPECT_EQ(value("right.armed"), 1);
  EXPECT_EQ(value("left.armed"), 0);
  EXPECT_EQ(value("right.analogue5"), -1.25);
  EXPECT_EQ(recording.find("left.z.q"), nullptr);
}

TEST_F(RecordingTest, ReadsBackWhatWasWritten) {
  write_records(path("a.hapticrec"), 1000);
  auto read = read_recording(path("a.hapticrec"));
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_EQ(read->size(), 1000u);
  EXPECT_EQ(read->torn_bytes, 0u);
  EXPECT_EQ(read->header.rate_Hz, 1000);
  EXPECT_EQ(read->header.config_digest, "0123456789abcdef");
  EXPECT_EQ(read->header.config_text, "version: 1\n");
  EXPECT_EQ(read->header.fields.size(), header().fields.size());
  const Field* tick = read->find("tick");
  ASSERT_NE(tick, nullptr);
  for (std::size_t i = 0; i < read->size(); ++i)
    ASSERT_EQ(read->value(i, *tick), static_cast<double>(i));
}

TEST_F(RecordingTest, HeaderLengthIsRightForEveryLengthOfConfig) {
  RecordingHeader made = header();
  for (std::size_t bytes = 0; bytes < 1200; ++bytes) {
    made.config_text = std::string(bytes, '\n');
    {
      auto writer = RecordingWriter::create(path("a"), made);
      ASSERT_TRUE(writer && writer->append(record(3).data()));
    }
    auto read = read_recording(path("a"));
    ASSERT_TRUE(read) << read.error().text;
    ASSERT_EQ(read->header.config_text.size(), bytes);
    ASSERT_EQ(read->size(), 1u);
    ASSERT_EQ(std::filesystem::file_size(path("a")) % 8, 0u);
  }
}

TEST_F(RecordingTest, RefusesToWriteAHeaderThatNobodyCouldRead) {
  RecordingHeader bad = header();
  bad.fields[0].name = "two words";
  auto writer = RecordingWriter::create(path("a"), bad);
  ASSERT_FALSE(writer);
  EXPECT_NE(writer.error().text.find("field 1"), std::string::npos) << writer.error().text;
  EXPECT_FALSE(std::filesystem::exists(path("a")));
}

TEST_F(RecordingTest, RefuseKeepsTheFileThatIsThere) {
  spill(path("a"), "precious");
  EXPECT_FALSE(RecordingWriter::create(path("a"), header(), IfExists::refuse));
  EXPECT_EQ(slurp(path("a")), "precious");
}

TEST_F(RecordingTest, ErrorsNameThePathAndTheReason) {
  auto writer = RecordingWriter::create(path("no/such/dir"), header());
  ASSERT_FALSE(writer);
  EXPECT_NE(writer.error().text.find("no/such/dir"), std::string::npos);
  EXPECT_NE(writer.error().text.find("No such file"), std::string::npos) << writer.error().text;
  EXPECT_EQ(writer.error().code, ExitCode::cannot_create);
}

TEST_F(Reading, ATornTailIsCutWhereverItTears) {
  write_records(path("a"), 3);
  const std::string whole = slurp(path("a"));
  const std::size_t record_bytes = header().record_bytes;
  for (std::size_t cut = 1; cut <= 2 * record_bytes; cut += 7) {
    spill(path("b"), whole.substr(0, whole.size() - cut));
    auto read = read_recording(path("b"));
    ASSERT_TRUE(read) << read.error().text;
    const std::size_t left = 3 * record_bytes - cut;
    ASSERT_EQ(read->size(), left / record_bytes);
    ASSERT_EQ(read->torn_bytes, left % record_bytes);
  }
}

TEST_F(Reading, AFileThatEndsInItsHeaderIsAnErrorAtEveryByte) {
  write_records(path("a"), 0);
  const std::string whole = slurp(path("a"));
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    spill(path("b"), whole.substr(0, bytes));
    auto read = read_recording(path("b"));
    ASSERT_FALSE(read) << bytes;
    ASSERT_EQ(read.error().code, ExitCode::bad_data);
  }
}

/// Every replacement makes the header say something that is not so.
TEST_F(Reading, HostileHeadersAreRefusedWithTheirLine) {
  write_records(path("a"), 2);
  const std::string good = slurp(path("a"));
  const struct {
    const char* from;
    const char* to;
    const char* told;
  } cases[] = {
      {"hapticd-recording 1", "hapticd-recording 2", "version 1"},
      {"hapticd-recording 1", "hapticd", "not a hapticd recording"},
      {"rate_Hz 1000", "rate_Hz nan", "rate_Hz"},
      {"rate_Hz 1000", "rate_Hz -1", "rate_Hz"},
      {"rate_Hz 1000", "rate_Hz 1e3x", "line 2: rate_Hz"},
      {"rate_Hz 1000", "rate 1000", "line 2: expected 'rate_Hz'"},
      {"config_digest 0123456789abcdef", "config_digest ", "line 3"},
      {"config_bytes 11", "config_bytes 18446744073709551615", "config"},
      {"config_bytes 11", "config_bytes 99999999999999999999", "line 4: config_bytes"},
      {"config_bytes 11", "config_bytes -1", "line 4"},
      {"record_bytes 4", "record_bytes 0", "record_bytes"},
      {"record_bytes 4", "record_bytes 99999999994", "line 5"},
      {"field tick - i64 0", "field tick - i64 4294967295", "offset"},
      {"field tick - i64 0", "field tick - f32 0", "type"},
      {"field tick - i64 0", "field tick - i64", "line 6"},
      {"field tick - i64 0", "field  - i64 0", "field 1"},
      {"field tick - i64 0", "field a,b - i64 0", "field 1"},
      {"field time_ns", "field tick", "twice"},
      {"header_bytes ", "header_bytes 9", "header_bytes"},
      {"\nend\n", "\nfin\n", "expected 'end'"},
  };
  for (const auto& c : cases) {
    std::string text = good;
    const std::size_t at = text.find(c.from);
    ASSERT_NE(at, std::string::npos) << c.from;
    text.replace(at, std::string(c.from).size(), c.to);
    spill(path("b"), text);
    auto read = read_recording(path("b"));
    ASSERT_FALSE(read) << c.to;
    EXPECT_NE(read.error().text.find(c.told), std::string::npos)
        << c.to << " gave: " << read.error().text;
    EXPECT_EQ(read.error().code, ExitCode::bad_data);
  }
}

TEST_F(Reading, OneChangedByteNeverCrashesTheReader) {
  write_records(path("a"), 2);
  const std::string good = slurp(path("a"));
  for (std::size_t i = 0; i < good.size(); i += 3) {
    for (const char byte : {'\0', '\n', ' ', '9', '-', '\xff'}) {
      std::string text = good;
      text[i] = byte;
      spill(path("b"), text);
      auto read = read_recording(path("b"));
      if (!read) continue;
      for (const Field& field : read->header.fields) {
        for (std::size_t k = 0; k < read->size(); ++k) (void)read->value(k, field);
      }
    }
  }
}

TEST_F(Reading, WhatIsNoFileIsAnErrorAndNotAHang) {
  EXPECT_EQ(read_recording(path("none")).error().code, ExitCode::no_input);
  EXPECT_EQ(read_recording(dir_.string()).error().code, ExitCode::no_input);
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(read_recording(path("pipe")).error().code, ExitCode::no_input);
  spill(path("empty"), "");
  EXPECT_EQ(read_recording(path("empty")).error().code, ExitCode::bad_data);
}

TEST_F(Reading, ASparseGiantIsRefusedInsteadOfFillingTheMemory) {
  write_records(path("a"), 1);
  ASSERT_EQ(::truncate(path("a").c_str(), std::int64_t{1} << 42), 0);
  struct rlimit before {};
  ::getrlimit(RLIMIT_AS, &before);
  const struct rlimit small { rlim_t{2} << 30, before.rlim_max };
#ifdef HAPTICD_SANITIZED
  GTEST_SKIP() << "sanitizers need an address space that this test would not leave them";
#endif
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &small), 0);
  auto read = read_recording(path("a"));
  ::setrlimit(RLIMIT_AS, &before);
  ASSERT_FALSE(read);
  EXPECT_NE(read.error().text.find("memory"), std::string::npos) << read.error().text;
}

TEST_F(RecordingTest, CsvHasOneTitleAndOneLineARecord) {
  Recording recording;
  recording.header = {.rate_Hz = 1000,
                      .config_digest = {},
                      .config_text = {},
                      .record_bytes = 24,
                      .fields = {{"n", "-", "i64", 0}, {"x", "m", "f64", 8}, {"u", "-", "u8", 16}}};
  const double values[] = {0.1, std::nan(""), -std::numeric_limits<double>::infinity()};
  for (const double x : values) {
    std::vector<std::byte> bytes(24);
    const std::int64_t n = std::numeric_limits<std::int64_t>::min();
    std::memcpy(bytes.data(), &n, 8);
    std::memcpy(bytes.data() + 8, &x, 8);
    bytes[16] = std::byte{255};
    recording.data.insert(recording.data.end(), bytes.begin(), bytes.end());
  }
  ASSERT_TRUE(write_csv(recording, path("a.csv")));
  EXPECT_EQ(slurp(path("a.csv")),
            "n,x[m],u\n"
            "-9223372036854775808,0.10000000000000001,255\n"
            "-9223372036854775808,nan,255\n"
            "-9223372036854775808,-inf,255\n");
}

TEST_F(RecordingTest, CsvOntoAFullDiskSaysSo) {
  write_records(path("a"), 10);
  auto written = write_csv(*read_recording(path("a")), "/dev/full");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().text.find("No space left"), std::string::npos) << written.error().text;
}

/// Appends until the disk refuses; what the error says must be what can be read.
void fill_up(RecordingWriter& writer, const std::vector<std::byte>& record,
             const std::string& reason) {
  Result<void> result;
  for (int i = 0; i < 100'000 && result; ++i) result = writer.append(record.data());
  ASSERT_FALSE(result) << "the disk never became full";
  EXPECT_NE(result.error().text.find(reason), std::string::npos) << result.error().text;
  EXPECT_NE(result.error().text.find(writer.path()), std::string::npos) << result.error().text;
  EXPECT_FALSE(writer.append(record.data())) << "an error stands";
  EXPECT_FALSE(writer.close());
  auto read = read_recording(writer.path());
  ASSERT_TRUE(read) << read.error().text;
  EXPECT_GT(read->size(), 0u);
  const std::string told = "the " + std::to_string(read->size()) + " whole records";
  EXPECT_NE(result.error().text.find(told), std::string::npos)
      << result.error().text << ", read " << read->size();
}

TEST_F(RecordingTest, AFileSizeLimitLeavesAllWholeRecordsReadable) {
  std::signal(SIGXFSZ, SIG_IGN);
  auto writer = RecordingWriter::create(path("a"), header());
  ASSERT_TRUE(writer);
  struct rlimit before {};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const struct rlimit small { 100'001, before.rlim_max };
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  fill_up(*writer, record(1), "File too large");
  ::setrlimit(RLIMIT_FSIZE, &before);
}

TEST_F(RecordingTest, AFullDiskLeavesAllWholeRecordsReadable) {
  const std::string disk = path("disk");
  std::filesystem::create_directory(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=256k") != 0) {
    GTEST_SKIP() << "mounting a small tmpfs needs root; the file size limit above stands for it";
  }
  auto writer = RecordingWriter::create(disk + "/a", header());
  EXPECT_TRUE(writer);
  if (writer) fill_up(*writer, record(1), "No space left on device");
  ::umount(disk.c_str());
}

}  // namespace
}  // namespace hapticd::daemon
