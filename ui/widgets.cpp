#include "ui/widgets.h"

#include <algorithm>

namespace sonoband::ui {

std::uint64_t Widgets::add(std::string_view name, const Rect& rect, bool enabled) {
  Widget w;
  w.id = id_of(name);
  std::copy_n(name.data(), std::min(name.size(), w.name.size() - 1), w.name.data());
  w.rect = rect;
  w.enabled = enabled;
  all_.push_back(w);
  return w.id;
}

std::uint64_t Widgets::hit(Vec2 p) const {
  for (auto w = all_.rbegin(); w != all_.rend(); ++w) {
    if (w->rect.contains(p)) return w->enabled ? w->id : 0;
  }
  return 0;
}

std::optional<Widget> Widgets::find(std::string_view name) const {
  const std::uint64_t id = id_of(name);
  for (auto w = all_.rbegin(); w != all_.rend(); ++w) {
    if (w->id == id) return *w;
  }
  return std::nullopt;
}

}  // namespace sonoband::ui
