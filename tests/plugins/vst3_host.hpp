// SPDX-License-Identifier: MIT
// A small VST3 host.
#pragma once

#include <travesty/audio_processor.h>
#include <travesty/bstream.h>
#include <travesty/component.h>
#include <travesty/edit_controller.h>
#include <travesty/factory.h>
#include <travesty/host.h>
#include <travesty/message.h>
#include <travesty/unit.h>
#include <travesty/view.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <span>

#include "contactspline/midi/midi_interpreter.hpp"
#include "plugins/hosted_plugin.hpp"

namespace contactspline::testing {

/// An object of the host as VST3 passes it: a pointer to a pointer to the table of functions, which come after the
/// three of v3_funknown. `self` of the functions is this object.
template <typename Functions>
class HostObject {
 public:
  using Query = v3_result(void*, const v3_tuid, void**);
  explicit HostObject(const Functions& functions, Query* query = nullptr) {
    table_.functions = functions;
    if (query != nullptr) table_.unknown.query_interface = query;
  }
  HostObject(const HostObject&) = delete;
  HostObject& operator=(const HostObject&) = delete;

  [[nodiscard]] Functions** pointer() { return reinterpret_cast<Functions**>(&pointer_); }

 protected:
  // Derived classes add members behind pointer_, so `self` leads to them.
  template <typename Derived>
  static Derived& of(void* self) {
    return *static_cast<Derived*>(static_cast<HostObject*>(self));
  }

 private:
  struct Table {
    v3_funknown unknown = {[](void*, const v3_tuid, void**) { return static_cast<v3_result>(V3_NO_INTERFACE); },
                           [](void*) -> std::uint32_t { return 1; }, [](void*) -> std::uint32_t { return 1; }};
    Functions functions;
  };

  Table* pointer_ = &table_;  // first: its address is the object's
  Table table_;
};

/// The notes of a block.
class EventList : public HostObject<v3_event_list> {
 public:
  EventList()
      : HostObject({[](void* self) { return static_cast<std::uint32_t>(of<EventList>(self).events.size()); },
                    [](void* self, std::int32_t i, v3_event* event) {
                      *event = of<EventList>(self).events[static_cast<std::size_t>(i)];
                      return static_cast<v3_result>(V3_OK);
                    },
                    [](void*, v3_event*) { return static_cast<v3_result>(V3_NOT_IMPLEMENTED); }}) {}

  std::vector<v3_event> events;
};

/// A change of one parameter within a block.
class ParameterChange : public HostObject<v3_param_value_queue> {
 public:
  ParameterChange(v3_param_id id, std::int32_t time, double normalised)
      : HostObject(
            {[](void* self) { return of<ParameterChange>(self).id_; }, [](void*) { return 1; },
             [](void* self, std::int32_t, std::int32_t* at, double* value) {
               *at = of<ParameterChange>(self).time_;
               *value = of<ParameterChange>(self).normalised_;
               return static_cast<v3_result>(V3_OK);
             },
             [](void*, std::int32_t, double, std::int32_t*) { return static_cast<v3_result>(V3_NOT_IMPLEMENTED); }}),
        id_(id),
        time_(time),
        normalised_(normalised) {}

 private:
  v3_param_id id_;
  std::int32_t time_;
  double normalised_;
};

/// What a plug-in tells of its parameters within a block: the last value of each.
class ReadingChanges : public HostObject<v3_param_changes> {
 public:
  static constexpr std::size_t kMax = 64;

  ReadingChanges()
      : HostObject({[](void* self) { return static_cast<std::int32_t>(of<ReadingChanges>(self).count_); },
                    [](void*, std::int32_t) -> v3_param_value_queue** { return nullptr; },
                    [](void* self, v3_param_id* id, std::int32_t* index) -> v3_param_value_queue** {
                      return of<ReadingChanges>(self).add(*id, *index);
                    }}) {}

  /// The part of the slider; 0 where the plug-in has told none.
  [[nodiscard]] double part(v3_param_id id) const {
    for (std::size_t i = 0; i < count_; ++i)
      if (readings_[i].id == id) return readings_[i].part;
    return 0;
  }

 private:
  struct Reading : HostObject<v3_param_value_queue> {
    Reading()
        : HostObject(
              {[](void* self) { return of<Reading>(self).id; }, [](void*) { return 1; },
               [](void*, std::int32_t, std::int32_t*, double*) { return static_cast<v3_result>(V3_NOT_IMPLEMENTED); },
               [](void* self, std::int32_t, double value, std::int32_t* index) {
                 of<Reading>(self).part = value;
                 *index = 0;
                 return static_cast<v3_result>(V3_OK);
               }}) {}
    v3_param_id id = 0;
    double part = 0;
  };

  v3_param_value_queue** add(v3_param_id id, std::int32_t& index) {
    std::size_t i = 0;
    while (i < count_ && readings_[i].id != id) ++i;
    if (i == kMax) return nullptr;
    count_ = std::max(count_, i + 1);
    readings_[i].id = id;
    index = static_cast<std::int32_t>(i);
    return readings_[i].pointer();
  }

  std::array<Reading, kMax> readings_;
  std::size_t count_ = 0;
};

/// All changes of parameters within a block.
class ParameterChanges : public HostObject<v3_param_changes> {
 public:
  ParameterChanges()
      : HostObject({[](void* self) { return static_cast<std::int32_t>(of<ParameterChanges>(self).changes.size()); },
                    [](void* self, std::int32_t i) {
                      return of<ParameterChanges>(self).changes[static_cast<std::size_t>(i)]->pointer();
                    },
                    [](void*, v3_param_id*, std::int32_t*) -> v3_param_value_queue** { return nullptr; }}) {}

  std::vector<std::unique_ptr<ParameterChange>> changes;
};

/// What a plug-in tells the host's side of its controller.
class ComponentHandler : public HostObject<v3_component_handler> {
 public:
  ComponentHandler()
      : HostObject({[](void*, v3_param_id) { return static_cast<v3_result>(V3_OK); },
                    [](void* self, v3_param_id id, double part) {
                      of<ComponentHandler>(self).edits.emplace_back(id, part);
                      return static_cast<v3_result>(V3_OK);
                    },
                    [](void*, v3_param_id) { return static_cast<v3_result>(V3_OK); },
                    [](void* self, std::int32_t flags) {
                      ++of<ComponentHandler>(self).restarts;
                      of<ComponentHandler>(self).latency_changes += (flags & V3_RESTART_LATENCY_CHANGED) != 0;
                      return static_cast<v3_result>(V3_OK);
                    }}) {}

  std::size_t restarts = 0, latency_changes = 0;
  std::vector<std::pair<v3_param_id, double>> edits;  ///< values as parts of the slider
};

/// What the window and the plug-in tell each other.
class Message : public HostObject<v3_message>, public HostObject<v3_attribute_list> {
 public:
  Message()
      : HostObject<v3_message>({[](void* self) { return message(self).id_.c_str(); },
                                [](void* self, const char* id) { message(self).id_ = id; },
                                [](void* self) { return message(self).HostObject<v3_attribute_list>::pointer(); }}),
        HostObject<v3_attribute_list>(
            {[](void* self, const char* id, std::int64_t value) { return set(self, id, &value, sizeof value); },
             [](void* self, const char* id, std::int64_t* value) { return get(self, id, value, sizeof *value); },
             [](void* self, const char* id, double value) { return set(self, id, &value, sizeof value); },
             [](void* self, const char* id, double* value) { return get(self, id, value, sizeof *value); },
             [](void*, const char*, const std::int16_t*) { return static_cast<v3_result>(V3_NOT_IMPLEMENTED); },
             [](void*, const char*, std::int16_t*, std::uint32_t) {
               return static_cast<v3_result>(V3_NOT_IMPLEMENTED);
             },
             [](void* self, const char* id, const void* data, std::uint32_t size) {
               return set(self, id, data, size);
             },
             [](void* self, const char* id, const void** data, std::uint32_t* size) {
               const std::string& bytes = attributes(self).values_[id];
               *data = bytes.data();
               *size = static_cast<std::uint32_t>(bytes.size());
               return static_cast<v3_result>(V3_OK);
             }}) {}

  using HostObject<v3_message>::pointer;

 private:
  static Message& message(void* self) { return HostObject<v3_message>::of<Message>(self); }
  static Message& attributes(void* self) { return HostObject<v3_attribute_list>::of<Message>(self); }
  static v3_result set(void* self, const char* id, const void* data, std::size_t size) {
    attributes(self).values_[id].assign(static_cast<const char*>(data), size);
    return V3_OK;
  }
  static v3_result get(void* self, const char* id, void* data, std::size_t size) {
    const auto& values = attributes(self).values_;
    const auto found = values.find(id);
    if (found == values.end() || found->second.size() != size) return V3_INVALID_ARG;
    std::memcpy(data, found->second.data(), size);
    return V3_OK;
  }

  std::string id_;
  std::map<std::string, std::string> values_;
};

/// The host itself, which makes messages and keeps them until it forgets them.
class HostApplication : public HostObject<v3_host_application> {
 public:
  HostApplication()
      : HostObject({[](void*, v3_str_128 name) {
                      name[0] = 0;
                      return static_cast<v3_result>(V3_OK);
                    },
                    [](void* self, v3_tuid, v3_tuid, void** object) {
                      auto& made = of<HostApplication>(self).messages;
                      made.push_back(std::make_unique<Message>());
                      *object = made.back()->pointer();
                      return static_cast<v3_result>(V3_OK);
                    }},
                   [](void* self, const v3_tuid id, void** object) {
                     if (!v3_tuid_match(id, v3_host_application_iid)) return static_cast<v3_result>(V3_NO_INTERFACE);
                     *object = of<HostApplication>(self).pointer();
                     return static_cast<v3_result>(V3_OK);
                   }) {}

  std::vector<std::unique_ptr<Message>> messages;
};

/// Timers of windows.
class RunLoop : public HostObject<v3_run_loop> {
 public:
  RunLoop()
      : HostObject({[](void*, v3_event_handler**, int) { return static_cast<v3_result>(V3_OK); },
                    [](void*, v3_event_handler**) { return static_cast<v3_result>(V3_OK); },
                    [](void* self, v3_timer_handler** timer, std::uint64_t) {
                      of<RunLoop>(self).timers.push_back(timer);
                      return static_cast<v3_result>(V3_OK);
                    },
                    [](void* self, v3_timer_handler** timer) {
                      std::erase(of<RunLoop>(self).timers, timer);
                      return static_cast<v3_result>(V3_OK);
                    }}) {}

  std::vector<v3_timer_handler**> timers;
};

/// What holds a window, which finds the timers by it.
class Frame : public HostObject<v3_plugin_frame> {
 public:
  Frame()
      : HostObject(
            {[](void*, v3_plugin_view** view, v3_view_rect* size) { return v3_cpp_obj(view)->on_size(view, size); }},
            [](void* self, const v3_tuid id, void** object) {
              if (!v3_tuid_match(id, v3_run_loop_iid)) return static_cast<v3_result>(V3_NO_INTERFACE);
              *object = of<Frame>(self).loop.pointer();
              return static_cast<v3_result>(V3_OK);
            }) {}

  RunLoop loop;
};

/// Bytes in memory.
class ByteStream : public HostObject<v3_bstream> {
 public:
  explicit ByteStream(std::string content = "")
      : HostObject({[](void* self, void* buffer, std::int32_t size, std::int32_t* read) {
                      auto& stream = of<ByteStream>(self);
                      const auto count = std::min(static_cast<std::size_t>(size), stream.bytes.size() - stream.done_);
                      std::memcpy(buffer, stream.bytes.data() + stream.done_, count);
                      stream.done_ += count;
                      *read = static_cast<std::int32_t>(count);
                      return static_cast<v3_result>(V3_OK);
                    },
                    [](void* self, void* buffer, std::int32_t size, std::int32_t* written) {
                      of<ByteStream>(self).bytes.append(static_cast<const char*>(buffer),
                                                        static_cast<std::size_t>(size));
                      *written = size;
                      return static_cast<v3_result>(V3_OK);
                    },
                    [](void*, std::int64_t, std::int32_t, std::int64_t*) {
                      return static_cast<v3_result>(V3_NOT_IMPLEMENTED);
                    },
                    [](void*, std::int64_t*) { return static_cast<v3_result>(V3_NOT_IMPLEMENTED); }}),
        bytes(std::move(content)) {}

  std::string bytes;

 private:
  std::size_t done_ = 0;
};

class Vst3Plugin : public HostedPlugin {
 public:
  /// file: the binary in the bundle.
  Vst3Plugin(const std::filesystem::path& file, double sample_rate_hz) : library_(file) {
    require(enter(), "cannot be entered");
    factory_ = static_cast<v3_plugin_factory**>(library_.symbol<void*()>("GetPluginFactory")());
    require(v3_cpp_obj(factory_)->num_classes(factory_) == 1, "classes");
    check(v3_cpp_obj(factory_)->get_class_info(factory_, 0, &class_));
    void* instance = nullptr;
    check(v3_cpp_obj(factory_)->create_instance(factory_, class_.class_id, v3_component_iid, &instance));
    component_ = static_cast<v3_component**>(instance);
    check(v3_cpp_obj_initialize(component_, reinterpret_cast<v3_funknown**>(application_.pointer())));
    check(v3_cpp_obj_query_interface(component_, v3_audio_processor_iid, &processor_));
    check(v3_cpp_obj_query_interface(component_, v3_edit_controller_iid, &controller_));
    check(v3_cpp_obj(controller_)->set_component_handler(controller_, handler_.pointer()));
    check(v3_cpp_obj_query_interface(controller_, v3_midi_mapping_iid, &mapping_));
    v3_process_setup setup = {V3_REALTIME, V3_SAMPLE_32, kMaxBlock, sample_rate_hz};
    check(v3_cpp_obj(processor_)->setup_processing(processor_, &setup));
    check(v3_cpp_obj(component_)->activate_bus(component_, V3_AUDIO, V3_OUTPUT, 0, true));
    check(v3_cpp_obj(component_)->set_active(component_, true));
    v3_cpp_obj(processor_)->set_processing(processor_, true);
    check(v3_cpp_obj_query_interface(controller_, v3_unit_information_iid, &units_));
    for (std::int32_t i = 0; i < count(); ++i) {
      const v3_param_info info = this->info(i);
      if (!(info.flags & V3_PARAM_IS_HIDDEN)) ids_[text(info.title)] = info.param_id;
      if (info.flags & V3_PARAM_PROGRAM_CHANGE) program_ = info;
      if (info.flags & V3_PARAM_READ_ONLY) read_only_.insert(info.param_id);
    }
    list_.events.reserve(64);
  }
  ~Vst3Plugin() override {
    v3_cpp_obj(processor_)->set_processing(processor_, false);
    v3_cpp_obj(component_)->set_active(component_, false);
    v3_cpp_obj_unref(units_);
    v3_cpp_obj_unref(mapping_);
    v3_cpp_obj_unref(controller_);
    v3_cpp_obj_unref(processor_);
    v3_cpp_obj_terminate(component_);
    v3_cpp_obj_unref(component_);
    v3_cpp_obj_unref(factory_);
    library_.symbol<bool()>(kExit)();
  }

  [[nodiscard]] const v3_class_info& class_info() const { return class_; }

  /// How many parameters a host finds, hidden ones among them.
  [[nodiscard]] std::int32_t count() const { return v3_cpp_obj(controller_)->get_parameter_count(controller_); }

  /// The largest difference between what a host reads of a parameter, hidden ones among them, and its first value,
  /// both as parts.
  [[nodiscard]] double from_defaults() const {
    double largest = 0;
    for (std::int32_t i = 0; i < count(); ++i) {
      v3_param_info info = {};
      if (v3_cpp_obj(controller_)->get_parameter_info(controller_, i, &info) != V3_OK) return 1;
      const double part = v3_cpp_obj(controller_)->get_parameter_normalised(controller_, info.param_id);
      if ((info.flags & V3_PARAM_READ_ONLY) == 0)
        largest = std::max(largest, std::abs(part - info.default_normalised_value));
    }
    return largest;
  }

  [[nodiscard]] std::vector<HostedParameter> parameters() const override { return parameters(false); }
  [[nodiscard]] std::vector<HostedParameter> readings() const override { return parameters(true); }

  /// The value at a part of the slider, as hosts ask for it.
  [[nodiscard]] double value_at(const std::string& parameter, double part) const {
    return plain(ids_.at(parameter), part);
  }
  [[nodiscard]] double part_of(const std::string& parameter, double value) const {
    return v3_cpp_obj(controller_)->plain_parameter_to_normalised(controller_, ids_.at(parameter), value);
  }
  [[nodiscard]] std::uint32_t tail() const { return v3_cpp_obj(processor_)->get_tail_samples(processor_); }

  [[nodiscard]] double value(const std::string& parameter) override {
    const v3_param_id id = ids_.at(parameter);
    if (read_only_.contains(id)) return told_value(parameter);
    return plain(id, v3_cpp_obj(controller_)->get_parameter_normalised(controller_, id));
  }

  void set(const std::string& parameter, double value, std::uint32_t time = 0) override {
    const v3_param_id id = ids_.at(parameter);
    change(id, static_cast<std::int32_t>(time),
           v3_cpp_obj(controller_)->plain_parameter_to_normalised(controller_, id, value));
  }

  void send(std::uint32_t time, std::array<std::uint8_t, 3> message) override {
    v3_event event = {};
    event.sample_offset = static_cast<std::int32_t>(time);
    const float velocity = message[2] / 127.0f;
    const std::int16_t channel = message[0] & 0x0f;
    switch (message[0] & 0xf0) {
      case 0x90:
        event.type = V3_EVENT_NOTE_ON;
        event.note_on = {channel, message[1], 0, velocity, 0, -1};
        return list_.events.push_back(event);
      case 0x80:
        event.type = V3_EVENT_NOTE_OFF;
        event.note_off = {channel, message[1], velocity, -1, 0};
        return list_.events.push_back(event);
      case 0xb0:
        return move_controller(channel, message[1], event.sample_offset, message[2] / 127.0);
      case 0xe0:
        return move_controller(channel, kPitchWheel, event.sample_offset, (message[2] << 7 | message[1]) / 16383.0);
      default:
        return;  // the format has no such events
    }
  }

  // Notes by name, as hosts of this format have them. cents: above its key.
  void note_on(const NoteName& name, double velocity, std::uint32_t time = 0, double cents = 0) {
    v3_event event = event_at(time, V3_EVENT_NOTE_ON);
    event.note_on = {static_cast<std::int16_t>(name.channel),
                     static_cast<std::int16_t>(name.key),
                     static_cast<float>(cents),
                     static_cast<float>(velocity),
                     0,
                     name.id};
    list_.events.push_back(event);
  }
  void note_off(const NoteName& name, double velocity, std::uint32_t time = 0) {
    v3_event event = event_at(time, V3_EVENT_NOTE_OFF);
    event.note_off = {static_cast<std::int16_t>(name.channel), static_cast<std::int16_t>(name.key),
                      static_cast<float>(velocity), name.id, 0};
    list_.events.push_back(event);
  }
  void press_key(int channel, int key, double pressure) {
    v3_event event = event_at(0, V3_EVENT_POLY_PRESSURE);
    event.poly_pressure = {static_cast<std::int16_t>(channel), static_cast<std::int16_t>(key),
                           static_cast<float>(pressure), -1};
    list_.events.push_back(event);
  }
  /// expression: of VST3; part: of its way, 0 to 1.
  void express(std::uint32_t expression, int id, double part, std::uint32_t time = 0) {
    v3_event event = event_at(time, V3_EVENT_NOTE_EXP_VALUE);
    event.note_exp_value = {expression, id, part};
    list_.events.push_back(event);
  }
  /// bytes: of an exclusive message of MIDI; they must outlive the block.
  void send_exclusive(std::span<const std::uint8_t> bytes) {
    v3_event event = event_at(0, V3_EVENT_DATA);
    event.data = {static_cast<std::uint32_t>(bytes.size()), 0, bytes.data()};
    list_.events.push_back(event);
  }
  /// An interface of the controller; null where it has none.
  template <typename Interface>
  [[nodiscard]] Interface** of_controller(const v3_tuid id) {
    Interface** found = nullptr;
    return v3_cpp_obj_query_interface(controller_, id, &found) == V3_OK ? found : nullptr;
  }

  [[nodiscard]] bool has_input() override {
    const std::int32_t inputs = v3_cpp_obj(component_)->get_bus_count(component_, V3_AUDIO, V3_INPUT);
    if (inputs == 0) return false;
    v3_bus_info info = {};
    check(v3_cpp_obj(component_)->get_bus_info(component_, V3_AUDIO, V3_INPUT, 0, &info));
    require(inputs == 1 && info.channel_count == 1 && info.bus_type == V3_AUX && text(info.bus_name) == "body",
            "another input");
    check(v3_cpp_obj(component_)->activate_bus(component_, V3_AUDIO, V3_INPUT, 0, true));
    return true;
  }

  /// As hosts list them: by the units of the plug-in.
  [[nodiscard]] std::vector<std::string> programs() override {
    v3_unit_info root = {};
    check(v3_cpp_obj(units_)->get_unit_info(units_, 0, &root));
    if (v3_cpp_obj(units_)->get_program_list_count(units_) == 0) return {};
    v3_program_list_info list = {};
    check(v3_cpp_obj(units_)->get_program_list_info(units_, 0, &list));
    require(list.id == root.program_list_id, "the root has no programs");
    std::vector<std::string> names;
    for (int i = 0; i < list.programCount; ++i) {
      v3_str_128 name = {}, shown = {};
      check(v3_cpp_obj(units_)->get_program_name(units_, list.id, i, name));
      check(v3_cpp_obj(controller_)
                ->get_parameter_string_for_value(controller_, program_.param_id, normalised_program(i), shown));
      require(text(name) == text(shown), "a program has two names");
      names.push_back(text(name));
    }
    return names;
  }

  void load_program(std::size_t index) override {
    const std::size_t restarts = handler_.restarts;
    check(
        v3_cpp_obj(controller_)
            ->set_parameter_normalised(controller_, program_.param_id, normalised_program(static_cast<int>(index))));
    require(handler_.restarts == restarts,
            "a host that is called back from here may wait for itself, as Ardour does");
  }

  void open_window(std::uintptr_t parent, double scale) override {
    view_ = v3_cpp_obj(controller_)->create_view(controller_, "editor");
    require(view_ != nullptr, "no window");
    require(v3_cpp_obj(view_)->is_platform_type_supported(view_, V3_VIEW_PLATFORM_TYPE_NATIVE) == V3_TRUE,
            "not of this system");
    check(v3_cpp_obj(view_)->set_frame(view_, frame_.pointer()));
    v3_plugin_view_content_scale** scaled = nullptr;
    check(v3_cpp_obj_query_interface(view_, v3_plugin_view_content_scale_iid, &scaled));
    (void)v3_cpp_obj(scaled)->set_content_scale_factor(scaled,
                                                       static_cast<float>(scale));  // it keeps it until it opens
    v3_cpp_obj_unref(scaled);
    check(v3_cpp_obj(view_)->attached(view_, reinterpret_cast<void*>(parent), V3_VIEW_PLATFORM_TYPE_NATIVE));
  }
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> window_size() override {
    v3_view_rect size = {};
    check(v3_cpp_obj(view_)->get_size(view_, &size));
    return {size.right - size.left, size.bottom - size.top};
  }
  void resize_window(std::uint32_t width, std::uint32_t height) override {
    require(v3_cpp_obj(view_)->can_resize(view_) == V3_TRUE, "no resize");
    v3_view_rect size = {0, 0, static_cast<std::int32_t>(width), static_cast<std::int32_t>(height)};
    check(v3_cpp_obj(view_)->on_size(view_, &size));
  }
  void idle_window() override {
    const auto timers = frame_.loop.timers;
    // On Windows the plug-in has timers of its own.
    require(!timers.empty() || V3_VIEW_PLATFORM_TYPE_NATIVE == std::string(V3_VIEW_PLATFORM_TYPE_HWND), "no timer");
    for (v3_timer_handler** const timer : timers) v3_cpp_obj(timer)->on_timer(timer);
    application_.messages.clear();
    for (; edits_done_ < handler_.edits.size(); ++edits_done_) edits_.push(handler_.edits[edits_done_]);
  }
  void close_window() override {
    check(v3_cpp_obj(view_)->removed(view_));
    check(v3_cpp_obj(view_)->set_frame(view_, nullptr));
    v3_cpp_obj_unref(view_);
    application_.messages.clear();
  }
  [[nodiscard]] std::vector<std::pair<std::string, double>> told() override {
    std::vector<std::pair<std::string, double>> told;
    for (const auto& [edited, part] : handler_.edits)
      for (const auto& [name, id] : ids_)
        if (id == edited) told.emplace_back(name, plain(id, part));
    return told;
  }

  /// The value that the plug-in has told its host last, in a block.
  [[nodiscard]] double told_value(const std::string& parameter) const {
    const v3_param_id id = ids_.at(parameter);
    return plain(id, readings_.part(id));
  }

  [[nodiscard]] std::uint32_t latency() override { return v3_cpp_obj(processor_)->get_latency_samples(processor_); }
  [[nodiscard]] std::size_t latency_changes() const override { return handler_.latency_changes; }

  /// Tells the controller what a block has set, as hosts do.
  void tell_controller(const std::string& parameter, double value) {
    check(v3_cpp_obj(controller_)
              ->set_parameter_normalised(controller_, ids_.at(parameter), part_of(parameter, value)));
  }

  [[nodiscard]] std::string save() override {
    ByteStream stream;
    check(v3_cpp_obj(component_)->get_state(component_, stream.pointer()));
    return stream.bytes;
  }

  void restore(std::string saved) override {
    ByteStream stream(std::move(saved));
    check(v3_cpp_obj(component_)->set_state(component_, stream.pointer()));
  }

 private:
  static v3_event event_at(std::uint32_t time, std::uint16_t type) {
    v3_event event = {};
    event.sample_offset = static_cast<std::int32_t>(time);
    event.type = type;
    return event;
  }

#ifdef _WIN32
  static constexpr auto kExit = "ExitDll";
  [[nodiscard]] bool enter() const {
    return library_.symbol<bool()>("InitDll")();
  }
#else
  static constexpr auto kExit = "ModuleExit";
  [[nodiscard]] bool enter() const {
    return library_.symbol<bool(void*)>("ModuleEntry")(library_.handle());
  }
#endif

  static void require(bool holds, const char* what) {
    if (!holds) throw std::runtime_error(std::string("VST3: ") + what);
  }
  static void check(v3_result result) {
    if (result != V3_OK) throw std::runtime_error("VST3: result " + std::to_string(result));
  }

  static std::string text(const v3_str_128& ascii) {
    std::string text;
    for (const std::int16_t* c = ascii; *c != 0; ++c) text += static_cast<char>(*c);
    return text;
  }

  static constexpr std::int16_t kPitchWheel = 129;

  [[nodiscard]] double normalised_program(int index) const {
    return program_.step_count == 0 ? 0 : 1.0 * index / program_.step_count;
  }

  // Hosts drop a controller that the plug-in has no parameter for.
  void move_controller(std::int16_t channel, std::int16_t number, std::int32_t time, double normalised) {
    v3_param_id id = 0;
    if (v3_cpp_obj(mapping_)->get_midi_controller_assignment(mapping_, 0, channel, number, &id) != V3_TRUE) return;
    for (std::int32_t i = 0; i < count(); ++i)
      if (info(i).param_id == id) return change(id, time, std::min(normalised, 1.0));
    throw std::runtime_error("VST3: a controller moves a parameter that is not there");
  }

  [[nodiscard]] std::vector<HostedParameter> parameters(bool are_readings) const {
    std::vector<HostedParameter> parameters;
    for (std::int32_t i = 0; i < count(); ++i) {
      const v3_param_info info = this->info(i);
      if (info.flags & (V3_PARAM_IS_HIDDEN | V3_PARAM_PROGRAM_CHANGE)) continue;
      if (((info.flags & V3_PARAM_READ_ONLY) != 0) != are_readings) continue;
      parameters.push_back({text(info.title), text(info.units), plain(info.param_id, 0), plain(info.param_id, 1),
                            plain(info.param_id, info.default_normalised_value)});
    }
    return parameters;
  }

  [[nodiscard]] v3_param_info info(std::int32_t index) const {
    v3_param_info info = {};
    check(v3_cpp_obj(controller_)->get_parameter_info(controller_, index, &info));
    return info;
  }

  [[nodiscard]] double plain(v3_param_id id, double normalised) const {
    return v3_cpp_obj(controller_)->normalised_parameter_to_plain(controller_, id, normalised);
  }

  void change(v3_param_id id, std::int32_t time, double normalised) {
    changes_.changes.push_back(std::make_unique<ParameterChange>(id, time, normalised));
  }

  void process(float* signal, std::array<float*, 2> outputs, std::uint32_t samples) override {
    for (const auto& [id, part] : edits_.take()) change(id, 0, part);
    v3_audio_bus_buffers bus = {};
    bus.num_channels = 2;
    bus.channel_buffers_32 = outputs.data();
    v3_process_data data = {};
    data.process_mode = V3_REALTIME;
    data.symbolic_sample_size = V3_SAMPLE_32;
    data.nframes = static_cast<std::int32_t>(samples);
    v3_audio_bus_buffers input_bus = {};
    input_bus.num_channels = 1;
    input_bus.channel_buffers_32 = &signal;
    data.num_input_buses = signal == nullptr ? 0 : 1;
    data.inputs = signal == nullptr ? nullptr : &input_bus;
    data.num_output_buses = 1;
    data.outputs = &bus;
    data.input_params = changes_.pointer();
    data.output_params = readings_.pointer();
    data.input_events = list_.pointer();
    check(v3_cpp_obj(processor_)->process(processor_, &data));
    list_.events.clear();
    changes_.changes.clear();
  }

  Library library_;
  HostApplication application_;
  ComponentHandler handler_;
  Frame frame_;
  v3_plugin_view** view_ = nullptr;
  HandOver<std::pair<v3_param_id, double>> edits_;  // for the processor
  std::size_t edits_done_ = 0;                      // of the handler's
  v3_plugin_factory** factory_ = nullptr;
  v3_class_info class_ = {};
  v3_component** component_ = nullptr;
  v3_audio_processor** processor_ = nullptr;
  v3_edit_controller** controller_ = nullptr;
  v3_midi_mapping** mapping_ = nullptr;
  v3_unit_information** units_ = nullptr;
  v3_param_info program_ = {};
  std::map<std::string, v3_param_id> ids_;
  EventList list_;
  ParameterChanges changes_;
  ReadingChanges readings_;
  std::set<v3_param_id> read_only_;
};

}  // namespace contactspline::testing
