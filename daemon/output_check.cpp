#include "daemon/output_check.h"

#include <unistd.h>

#include <filesystem>

#include "daemon/plot_gnuplot.h"

namespace hapticd::daemon {

namespace fs = std::filesystem;

Result<void> check_output(const std::string& output, std::initializer_list<std::string> inputs) {
  std::error_code ignored;
  if (output == "-") return fail(ExitCode::usage, "expected the name of a file, found -");
  for (const std::string& input : inputs) {
    if (output != input && !fs::equivalent(output, input, ignored)) continue;
    return fail(ExitCode::usage,
                output + " is a file that is read or written here already; choose another name");
  }
  const fs::file_status status = fs::status(output, ignored);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return fail(ExitCode::cannot_create,
                output + (fs::is_directory(status) ? " is a directory" : " is not a regular file"));
  }
  const fs::path directory = fs::absolute(output).parent_path();
  if (!fs::is_directory(directory, ignored))
    return fail(ExitCode::cannot_create, output + ": there is no directory " + directory.string());
  if (::access(directory.c_str(), W_OK) == 0) return {};
  return fail(ExitCode::no_permission, output + ": its directory cannot be written");
}

Result<void> check_picture(const std::string& picture, std::initializer_list<std::string> inputs) {
  if (picture.empty()) return {};
  if (!picture.ends_with(".png") && !picture.ends_with(".svg"))
    return fail(ExitCode::usage, "expected a picture that ends in .png or .svg, found " + picture);
  if (auto writable = check_output(picture, inputs); !writable) return writable;
  auto answer = run_gnuplot("set print '-'\nprint 1\n");
  if (!answer) return tl::unexpected(answer.error());
  return {};
}

std::string named_from(const std::string& config, const std::string& file) {
  if (fs::path(file).is_absolute()) return file;
  const fs::path relative =
      fs::absolute(file).lexically_relative(fs::absolute(config).parent_path());
  return relative.empty() ? fs::absolute(file).string() : relative.string();
}

}  // namespace hapticd::daemon
