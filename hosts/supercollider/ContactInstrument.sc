// SPDX-License-Identifier: MIT
// Any instrument of Contact Spline: by its name, or by the path of an instrument file on the server's machine.
ContactInstrument : MultiOutUGen {
	// notes: [gate, key, velocity] each; events: [name, trigger] or [name, trigger, value] each; controls: name, signal, ...
	*ar { |name = "hammer_string", notes, events, controls, outputs|
		var named = { |list| [list.size] ++ list.collect { |row| this.text(row[0]) ++ row.drop(1) }.flatten(1) };
		outputs = outputs ? [\left, \right];
		if (outputs.isString or: { outputs.isKindOf(Symbol) }) { outputs = [outputs] };
		notes = notes ? [];
		events = (events ? []).reject { |event| event[1].isNil };
		events = events.collect { |event| [event[0], event[1], if (event[2].isNil) { 0 } { 1 }, event[2] ? 0] };
		controls = (controls ? []).clump(2).reject { |control| control[1].isNil };
		^this.multiNewList(['audio', outputs.size] ++ this.text(name) ++ named.(outputs.collect { |output| [output] })
			++ [notes.size] ++ notes.flatten(1) ++ named.(events) ++ named.(controls))
	}

	*text { |name|
		name = name.asString;
		^[name.size] ++ name.ascii.collect { |code| code.bitAnd(255) } // bytes have a sign
	}

	init { |count ... theInputs|
		inputs = theInputs;
		^this.initOutputs(count, rate)
	}
}
