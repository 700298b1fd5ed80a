-- SPDX-License-Identifier: MIT
-- For ardour_test, in ardour7-lua. "record FOLDER" makes a session there with a MIDI track for each plug-in, loads a
-- preset, moves a parameter, and records a note of the virtual keyboard on all tracks; "record FOLDER KEY:CENTS ..." a
-- chord of MPE on the channels from 2 on, each key bent by so much. "restore FOLDER" opens the session and bounces each
-- track into FOLDER/session/interchange/session/audiofiles/TRACK%L.wav. Both write what they see into FOLDER/MODE.txt,
-- in lines of words between tabs.
local mode, folder = arg[1], arg[2]
local out = assert(io.open(folder .. "/" .. mode .. ".txt", "w"))
local function tell(...) out:write(table.concat({...}, "\t"), "\n") out:flush() end

local function plugin_of(track) return track:the_instrument():to_insert():plugin(0) end

-- Calls f with the number, the parameter's number in the plug-in and its name, for what a user can set.
local function each_input(plugin, f)
  for i = 0, plugin:parameter_count() - 1 do
    local number = plugin:nth_parameter(i, true)
    local label = plugin:parameter_label(number)
    if plugin:parameter_is_control(number) and plugin:parameter_is_input(number) and label ~= "hidden" then
      f(i, number, label)
    end
  end
end

local function tell_values(track)
  tell("preset", track:name(), plugin_of(track):last_preset().label)
  each_input(plugin_of(track), function(i, _, label)
    local value, is_there = ARDOUR.LuaAPI.get_processor_param(track:the_instrument(), i, true)
    tell("value", track:name(), label, string.format("%.9g", value))
  end)
end

local function tracks_of(session)
  local tracks = {}
  for track in session:get_tracks():iter() do tracks[#tracks + 1] = track end
  return tracks
end

local function record(session)
  local midi, last_preset = ARDOUR.ChanCount(ARDOUR.DataType("midi"), 1), {}
  for info in ARDOUR.LuaAPI.list_plugins():iter() do
    local is_lv2, is_vst3 = info.type == ARDOUR.PluginType.LV2, info.type == ARDOUR.PluginType.VST3
    -- Those on the C++ runtime, beside which Faust's may lie.
    if info.name:find("^Contact Spline ") and (is_lv2 or is_vst3) then
      local name = (is_lv2 and "lv2 " or "vst3 ") .. info.name
      tell("found", name, tostring(info:is_instrument()))
      session:new_midi_track(midi, midi, false, info, nil, nil, 1, name, ARDOUR.PresentationInfo.max_order,
                             ARDOUR.TrackMode.Normal, false, true)
      -- Ardour lists those of LV2 here; a VST3 plug-in has the same, if it has more than one.
      for preset in info:get_presets():iter() do last_preset[info.name] = preset.label end
    end
  end
  local keyboard
  local _, ports = AudioEngine:get_ports(ARDOUR.DataType("midi"), ARDOUR.PortList())
  for port in ports[2]:iter() do
    if port:name() == "x-virtual-keyboard" then keyboard = port:to_asyncmidiport() end
  end
  for _, track in ipairs(tracks_of(session)) do
    local plugin, first = plugin_of(track)
    local preset = plugin:preset_by_label(last_preset[plugin:name()] or "")
    if preset then plugin:load_preset(preset) end
    each_input(plugin, function(i, number)
      if first then return end
      first = number
      local _, descriptor = plugin:get_parameter_descriptor(number, ARDOUR.ParameterDescriptor())
      local range = descriptor[2]
      ARDOUR.LuaAPI.set_processor_param(track:the_instrument(), i, (range.normal + range.upper) / 2)
    end)
    track:input():midi(0):connect(keyboard:name())
    track:rec_enable_control():set_value(1, PBD.GroupControlDisposition.NoGroup)
  end
  local function send(...)
    local parser = ARDOUR.RawMidiParser()
    for _, byte in ipairs({...}) do
      if parser:process_byte(byte) then keyboard:write(parser:midi_buffer(), parser:buffer_size(), 0) end
    end
  end
  local chord = {}
  for i = 3, #arg do
    local key, cents = arg[i]:match("^(%d+):(.+)$")
    chord[i - 2] = {key = tonumber(key), bend = math.floor(8192 + tonumber(cents) / 4800 * 8192 + 0.5)}
  end
  session:maybe_enable_record(false)
  session:request_roll(ARDOUR.TransportRequestSource.TRS_UI)
  -- Ardour keeps controllers apart, and would play those of one block in another order: wait for the next blocks.
  local function wait_for_blocks()
    local from = session:transport_sample()
    while session:transport_sample() < from + 4096 do sleep(0.01) end
  end
  wait_for_blocks()
  sleep(0.5)
  if #chord == 0 then send(0x90, 60, 100) end
  -- A zone of MPE on all channels.
  for _, controller in ipairs(#chord == 0 and {} or {{101, 0}, {100, 6}, {6, 15}}) do
    send(0xb0, controller[1], controller[2])
    wait_for_blocks()
  end
  for i, note in ipairs(chord) do
    send(0xe0 + i, note.bend % 128, note.bend // 128)
    wait_for_blocks()
    send(0x90 + i, note.key, 100)
  end
  sleep(1)
  if #chord == 0 then send(0x80, 60, 64) end
  for i, note in ipairs(chord) do send(0x80 + i, note.key, 64) end
  sleep(0.3)
  session:request_stop(false, false, ARDOUR.TransportRequestSource.TRS_UI)
  sleep(0.5)
  for _, track in ipairs(tracks_of(session)) do
    tell_values(track)
    for region in track:to_track():playlist():region_list():iter() do
      for note in ARDOUR.LuaAPI.note_list(region:to_midiregion():model()):iter() do
        tell("note", track:name(), tostring(note:note()), tostring(note:velocity()), tostring(note:time()),
             tostring(note:length()), tostring(region:position():samples()), tostring(note:channel()))
      end
    end
  end
  session:save_state("", false, false, false, false, false)
end

local session
if mode == "record" then
  session = create_session(folder .. "/session", "session", 48000)
  record(session)
else
  session = load_session(folder .. "/session", "session")
  for _, track in ipairs(tracks_of(session)) do
    tell_values(track)
    track:to_track():bounce_range(0, 3 * session:nominal_sample_rate(), ARDOUR.InterThreadInfo(), track:main_outs(),
                                  false, track:name())
  end
end
out:close()
session = nil
collectgarbage()
close_session()
quit()
