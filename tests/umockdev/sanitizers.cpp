// What the sanitizers ask a program for, where it is built with them.

extern "C" {

/// The wrapper's library comes before the sanitizer's.
const char* __asan_default_options();
const char* __asan_default_options() {
  return "verify_asan_link_order=0";
}

/// Of a transfer that never ends libusb cannot free its own part.
const char* __lsan_default_suppressions();
const char* __lsan_default_suppressions() {
  return "leak:libusb-1.0.so\n";
}

}  // extern "C"
