#include "ui/screen.h"

#include <GLES3/gl3.h>
#include <imgui.h>
#include <imgui_freetype.h>
#include <imgui_impl_opengl3.h>

#include <stdexcept>

#include "ui/draw_frame.h"
#include "ui/draw_kinds.h"
#include "ui/gl.h"
#include "ui/panels/panels.h"
#include "ui/scene.h"
#include "ui/shortcuts.h"
#include "ui/ui.h"
#include "ui/warm_up.h"

namespace sonoband::ui {
namespace {

// Latin, Greek, the punctuation, arrows and signs that the texts use.
constexpr ImWchar letters[] = {0x20,   0x17f,  0x391,  0x3c9,  0x2009, 0x2009, 0x2010, 0x2027, 0x202f, 0x202f,
                               0x2190, 0x2193, 0x2212, 0x2212, 0x2248, 0x2248, 0x2264, 0x2265, 0};
constexpr ImWchar symbols[] = {0xf000, 0xf2e0, 0};
constexpr float symbol_size = 30;  // rasterised once; every icon is scaled from it

// Sizes in units; in the order of Type.
struct TypeSize {
  float units;
  bool strong;
};
constexpr TypeSize type_sizes[] = {{13.5f, false}, {16, false}, {16, true}, {20, true}, {24, true}};

ImFont* add_font(ImFontAtlas& atlas, const std::vector<std::uint8_t>& file, float size, const ImWchar* ranges,
                 const char* what) {
  ImFontConfig config;
  config.FontDataOwnedByAtlas = false;  // the atlas only reads
  if (file.empty()) throw std::runtime_error(std::string("no font for ") + what + ": its file is empty");
  void* bytes = const_cast<std::uint8_t*>(file.data());
  return atlas.AddFontFromMemoryTTF(bytes, static_cast<int>(file.size()), size, &config, ranges);
}

}  // namespace

struct Screen::Parts {
  Parts(const ScreenSettings& s, const FontFiles& f, const Texts& t)
      : settings(s), fonts(f), texts(t), context(ImGui::CreateContext()) {
    ImGui::SetCurrentContext(context);
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr;
    io.LogFilename = nullptr;
    io.MouseDrawCursor = false;
    commands.reserve(64);
    gestures.reserve(64);
    if (!ImGui_ImplOpenGL3_Init("#version 300 es"))
      throw std::runtime_error("Dear ImGui's renderer does not start");
    pictures = std::make_unique<Pictures>(kinds, settings.bar);
    scene = std::make_unique<Scene>(*pictures, kinds);
    frame.pictures = pictures.get();
    frame.kinds = &kinds;
  }
  ~Parts() {
    ImGui::SetCurrentContext(context);
    scene.reset();
    pictures.reset();
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext(context);
  }

  void make_fonts();
  void measure(Vec2 size);
  void begin(Vec2 size);
  void submit();
  void recognise(const Input& input, Stamp now);
  void feed_pointer();

  ScreenSettings settings;
  FontFiles fonts;
  Texts texts;
  ImGuiContext* context;
  DrawKinds kinds;
  std::unique_ptr<Pictures> pictures;
  std::unique_ptr<Scene> scene;
  Draw::Frame frame;
  Metrics metrics;
  float font_unit = 0;
  Widgets widgets;
  GestureRecogniser recogniser{GestureLimits{}};
  std::vector<Gesture> gestures;
  std::uint64_t target = 0;  // of the fingers that are down
  Vec2 target_start;
  Commands commands;
  Stamp last{};
  Counts counts;
};

void Screen::Parts::make_fonts() {
  ImGuiIO& io = ImGui::GetIO();
  ImGui_ImplOpenGL3_DestroyFontsTexture();
  io.Fonts->Clear();
  io.Fonts->FontBuilderIO = ImGuiFreeType::GetBuilderForFreeType();
  for (std::size_t i = 0; i < frame.fonts.size(); ++i) {
    const TypeSize& size = type_sizes[i];
    frame.fonts[i] = add_font(*io.Fonts, size.strong ? fonts.strong : fonts.regular,
                              std::round(size.units * metrics.unit * 2) / 2, letters, "the text");
  }
  frame.icons =
      add_font(*io.Fonts, fonts.icons, std::round(symbol_size * metrics.unit), symbols, "the symbols");
  if (!io.Fonts->Build()) throw std::runtime_error("the fonts cannot be rasterised: are they damaged?");
  ImGui_ImplOpenGL3_CreateFontsTexture();
  frame.type_kind = texture_kind(GL_RGBA8, GL_LINEAR, io.Fonts->TexWidth, io.Fonts->TexHeight);
  font_unit = metrics.unit;
}

void Screen::Parts::measure(Vec2 size) {
  metrics =
      metrics_for(static_cast<int>(size.x), static_cast<int>(size.y), settings.width_mm, settings.scale);
}

// A frame of Dear ImGui, to be drawn on with `frame`.
void Screen::Parts::begin(Vec2 size) {
  ImGui::GetIO().DisplaySize = {size.x, size.y};
  if (font_unit != metrics.unit) make_fonts();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  frame.list = ImGui::GetBackgroundDrawList();
  frame.order_count = 0;
  frame.clear_count = 0;
  frame.noted_count = 0;
  frame.screen_width = size.x;
  frame.screen_height = size.y;
}

void Screen::Parts::submit() {
  glViewport(0, 0, static_cast<GLsizei>(frame.screen_width), static_cast<GLsizei>(frame.screen_height));
  glDisable(GL_SCISSOR_TEST);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  unsigned error = 0;
  counts.gl_errors += static_cast<std::uint64_t>(gl::take_errors(error));
}

// Gestures of this frame, each with what it landed on: the widget that the last frame had there, which is the
// one the user saw.
void Screen::Parts::recognise(const Input& input, Stamp now) {
  gestures.clear();
  const auto aim = [&](std::size_t from) {
    for (std::size_t i = from; i < gestures.size(); ++i) {
      if (gestures[i].kind == Gesture::Kind::press) {
        target = widgets.hit(gestures[i].start);
        target_start = gestures[i].start;
      }
      gestures[i].target = target;
    }
  };
  for (const Contact& contact : input.contacts) {
    const std::size_t before = gestures.size();
    recogniser.feed(contact, gestures);
    aim(before);
  }
  const std::size_t before = gestures.size();
  recogniser.tick(now, gestures);
  aim(before);

  for (const WheelEvent& wheel : input.wheels) {
    constexpr float zoom_per_notch = 1.12f;
    constexpr float turn_per_notch = 0.05f;  // 3 degrees
    constexpr float pixels_per_notch = 40;
    Gesture g;
    g.phase = Gesture::Phase::change;
    g.start = g.at = wheel.at;
    g.time = now;
    g.target = widgets.hit(wheel.at);
    if (wheel.control) {
      g.kind = Gesture::Kind::twist;
      g.turn_rad = turn_per_notch * wheel.step.y;
    } else if (wheel.shift) {
      g.kind = Gesture::Kind::two_finger_drag;
      g.step = pixels_per_notch * wheel.step;
    } else {
      g.kind = Gesture::Kind::pinch;
      g.scale = std::pow(zoom_per_notch, wheel.step.y);
    }
    gestures.push_back(g);
  }
}

// Dear ImGui gets one pointer, gone when the finger is: nothing may stay hovered.
void Screen::Parts::feed_pointer() {
  ImGuiIO& io = ImGui::GetIO();
  Vec2 at;
  const bool down = recogniser.finger(at);
#if IMGUI_VERSION_NUM >= 18700
  io.AddMousePosEvent(down ? at.x : -FLT_MAX, down ? at.y : -FLT_MAX);
  io.AddMouseButtonEvent(0, down);
#else
  io.MousePos = down ? ImVec2(at.x, at.y) : ImVec2(-FLT_MAX, -FLT_MAX);
  io.MouseDown[0] = down;
#endif
}

Screen::Screen(const ScreenSettings& settings, const FontFiles& fonts, const Texts& texts)
    : parts_(std::make_unique<Parts>(settings, fonts, texts)) {}

Screen::~Screen() = default;

const Commands& Screen::frame(const View& view, const Input& input, Stamp now, Vec2 size) {
  build(view, input, now, size);
  send_pictures();
  draw_outline();
  submit();
  return parts_->commands;
}

void Screen::warm_up(Vec2 size) {
  Parts& p = *parts_;
  ImGui::SetCurrentContext(p.context);
  p.measure(size);
  WarmUp unseen(*p.pictures, *p.scene);
  for (int i = 0; i < WarmUp::frames; ++i) {
    p.begin(size);
    Draw draw(p.frame);
    unseen.draw(i, draw);
    draw.end();
    ImGui::Render();
    p.pictures->send();
    p.scene->draw();
    p.submit();
  }
  // A driver may put the work off until somebody asks for it.
  glFinish();
  p.kinds.warm();
}

const Commands& Screen::build(const View& view, const Input& input, Stamp now, Vec2 size) {
  Parts& p = *parts_;
  ImGui::SetCurrentContext(p.context);
  p.commands.clear();
  const Metrics before = p.metrics;
  p.measure(size);
  if (before.px_per_mm != p.metrics.px_per_mm || p.counts.frames == 0) {
    p.recogniser = GestureRecogniser(limits_for(p.metrics.px_per_mm));
  }
  p.recognise(input, now);
  p.feed_pointer();
  ImGui::GetIO().DeltaTime = std::clamp(static_cast<float>(seconds(now - p.last)), 0.001f, 0.5f);
  p.last = now;
  p.begin(size);

  Draw draw(p.frame);
  Finger finger;
  finger.down = p.recogniser.finger(finger.at);
  finger.target = p.target;
  finger.start = p.target_start;
  p.widgets.clear();
  Ui ui{draw, p.widgets, p.metrics, p.texts, p.gestures, finger, now, *p.scene, *p.pictures, p.commands};
  send_shortcuts(ui, view, input);
  draw_screen(ui, view);
  draw.end();
  ImGui::Render();
  return p.commands;
}

void Screen::send_pictures() {
  parts_->pictures->send();
}

void Screen::draw_outline() {
  parts_->scene->draw();
}

void Screen::submit() {
  ImGui::SetCurrentContext(parts_->context);
  parts_->submit();
  ++parts_->counts.frames;
}

bool Screen::wants_frame() const {
  return parts_->recogniser.waiting();
}

const Widgets& Screen::widgets() const {
  return parts_->widgets;
}

const Metrics& Screen::metrics() const {
  return parts_->metrics;
}

Screen::Counts Screen::counts() const {
  Counts c = parts_->counts;
  c.uploads = parts_->pictures->uploads();
  c.scenes = parts_->scene->renders();
  c.kinds = parts_->kinds.met();
  c.late_kinds = parts_->kinds.met_late();
  return c;
}

}  // namespace sonoband::ui
