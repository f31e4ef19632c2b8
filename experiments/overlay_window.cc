#include "experiments/overlay_window.h"

#include <signal.h>
#include <stdio.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "common/support/input_error.h"
#include "experiments/command_line.h"

namespace duet {
namespace fs = std::filesystem;

void OverlayWindow::Closer::operator()(std::FILE* pipe) const { pclose(pipe); }

OverlayWindow::OverlayWindow() {
  const fs::path viewer = fs::read_symlink("/proc/self/exe").parent_path() / "duet_viewer";
  if (!fs::exists(viewer)) {
    throw InputError("--show: " + viewer.string() +
                     " was not built (it needs libopencv-highgui-dev); --save-overlay DIR writes "
                     "pictures instead");
  }
  if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr) {
    throw InputError("--show: there is no display; --save-overlay DIR writes pictures instead");
  }
  signal(SIGPIPE, SIG_IGN);  // a closed window ends the showing, not the tracking
  pipe_.reset(popen(ShellQuoted(viewer.string()).c_str(), "w"));
}

void OverlayWindow::Show(const cv::Mat& picture) {
  if (!pipe_) return;
  const std::int32_t size[2] = {picture.rows, picture.cols};
  bool written = std::fwrite(size, sizeof size, 1, pipe_.get()) == 1;
  for (int row = 0; written && row < picture.rows; ++row) {
    const auto columns = static_cast<std::size_t>(picture.cols);
    written = std::fwrite(picture.ptr(row), 3, columns, pipe_.get()) == columns;
  }
  if (!written || std::fflush(pipe_.get()) != 0) pipe_.reset();
}

}  // namespace duet
