// One macro for the compilers that can check at compile time and at run time that a function does
// not block (clang 20 and later, -fsanitize=realtime). It goes after noexcept.
#pragma once

#if defined(__clang__) && defined(__has_cpp_attribute)
#if __has_cpp_attribute(clang::nonblocking)
#define HAPTICD_NONBLOCKING [[clang::nonblocking]]
#endif
#endif
#ifndef HAPTICD_NONBLOCKING
#define HAPTICD_NONBLOCKING
#endif
