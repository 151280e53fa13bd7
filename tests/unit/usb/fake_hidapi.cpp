#include "tests/unit/usb/fake_hidapi.h"

#include <fcntl.h>
#include <hidapi/hidapi.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>

struct hid_device_ {};

namespace hapticd::test {

FakeHidapi& fake_hidapi() {
  static FakeHidapi fake;
  return fake;
}

}  // namespace hapticd::test

using hapticd::test::fake_hidapi;

extern "C" {

int hid_init() {
  return 0;
}

hid_device* hid_open_path(const char* path) {
  if (!fake_hidapi().refusal.empty()) return nullptr;
  fake_hidapi().opened = path;
  if (std::filesystem::is_character_file(path))
    fake_hidapi().descriptor = ::open(path, O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  static hid_device_ device;
  return &device;
}

const wchar_t* hid_error(hid_device*) {
  static std::wstring text;
  text.assign(fake_hidapi().refusal.begin(), fake_hidapi().refusal.end());
  return text.c_str();
}

void hid_close(hid_device*) {
  ++fake_hidapi().closed;
  if (fake_hidapi().descriptor >= 0) ::close(fake_hidapi().descriptor);
}

int hid_read_timeout(hid_device*, unsigned char* data, size_t length, int milliseconds) {
  auto& fake = fake_hidapi();
  fake.longest_wait_ms =
      std::max(fake.longest_wait_ms, milliseconds < 0 ? 1'000'000 : milliseconds);
  if (milliseconds != 0 && fake.while_waiting) fake.while_waiting();
  if (fake.descriptor >= 0) {
    const ssize_t got = ::read(fake.descriptor, data, length);
    return got < 0 ? 0 : static_cast<int>(got);
  }
  if (fake.waiting.empty()) {
    errno = fake.read_error;
    return fake.read_error == 0 ? 0 : -1;
  }
  const auto report = fake.waiting.front();
  fake.waiting.pop_front();
  const std::size_t size = std::min(length, report.size());
  std::copy_n(report.begin(), size, data);
  return static_cast<int>(size);
}

int hid_write(hid_device*, const unsigned char* data, size_t length) {
  auto& fake = fake_hidapi();
  if (fake.while_writing) fake.while_writing();
  errno = fake.write_error;
  if (fake.write_error != 0) return -1;
  fake.written.emplace_back(data, data + length);
  return static_cast<int>(length);
}

int hid_send_feature_report(hid_device*, const unsigned char* data, size_t length) {
  auto& fake = fake_hidapi();
  errno = fake.write_error;
  if (fake.write_error != 0) return -1;
  fake.features.emplace_back(data, data + length);
  return static_cast<int>(length);
}

int hid_get_feature_report(hid_device*, unsigned char* data, size_t length) {
  auto& fake = fake_hidapi();
  if (fake.feature.empty()) return -1;
  const std::size_t size = std::min(length, fake.feature.size());
  std::copy_n(fake.feature.begin(), size, data);
  return static_cast<int>(size);
}

}  // extern "C"
