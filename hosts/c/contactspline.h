/* SPDX-License-Identifier: MIT */
/* Contact Spline in C99: instruments by name or from a file's text, played in blocks. All values are in SI units.
 * An instrument is used by one thread at a time. What is said to be safe for audio neither allocates nor locks;
 * there, a null instrument, an index that is too large and a value that is not a number do nothing. */
#ifndef CONTACTSPLINE_H
#define CONTACTSPLINE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct contactspline_instrument contactspline_instrument;

/** The numbers that a model computes in. Either kind of process function plays either precision. */
enum contactspline_precision { CONTACTSPLINE_DOUBLE = 0, CONTACTSPLINE_FLOAT = 1 };

/** What can be set while an instrument plays. Text and lists live as long as the instrument. */
typedef struct contactspline_parameter {
  const char* name;  /**< lower-case identifier that ends with the unit: hammer_mass_kg */
  const char* unit;  /**< of SI; empty for a number */
  double min, max;   /**< values that are allowed; others are moved into the range */
  double slider_min; /**< where it is played, within the range */
  double slider_max;
  double initial;
  int is_logarithmic;    /**< 1: a slider moves in equal ratios */
  int acts_at_next_note; /**< 0: at once */
  double glide_s;        /**< time constant with which hosts should move it; 0: at once */
} contactspline_parameter;

typedef struct contactspline_output {
  const char* name;  /**< lower-case identifier that ends with the unit: bridge_force_n */
  const char* unit;  /**< of SI */
  double full_scale; /**< the value that hosts play as 1 */
} contactspline_output;

/** What can happen to an instrument. */
enum contactspline_action {
  CONTACTSPLINE_STRIKE = 0,   /**< number: of a strike; value: speed [m/s]; 0 lifts the damper without a blow */
  CONTACTSPLINE_RELEASE = 1,  /**< number: of a strike, whose damper comes down */
  CONTACTSPLINE_PLUCK = 2,    /**< number: of a pluck; value: force [N], which is reached within rise_s */
  CONTACTSPLINE_NOTE_ON = 3,  /**< number: key of MIDI; value: velocity, 0 to 1 */
  CONTACTSPLINE_NOTE_OFF = 4, /**< number: key of MIDI; value: release velocity, 0 to 1, or 0 where none is known */
  CONTACTSPLINE_SET = 5,      /**< number: of a parameter; value: in its unit */
  CONTACTSPLINE_BEND_KEY = 6, /**< number: key of MIDI; value: cents above its own pitch. This and the next two: of
                                   instruments with a voice for each key */
  CONTACTSPLINE_DAMP_KEY = 7, /**< number: key of MIDI; value: damping beside the damper's [1/s] */
  CONTACTSPLINE_PLACE_KEY = 8, /**< number: key of MIDI; value: place of its hammer from the next strike on [m] */
  CONTACTSPLINE_BOW = 9 /**< number: of a bow; value: its acceleration [m/s^2]; 0 lifts it */
};

/** What happens, and when. */
typedef struct contactspline_timed_event {
  size_t sample; /**< of the block, from its beginning */
  int action;    /**< contactspline_action */
  size_t number;
  double value;
  double rise_s; /**< of a pluck; else it does not matter */
} contactspline_timed_event;

/** What an instrument is played by, beside keys. */
typedef struct contactspline_event {
  const char* name; /**< lower-case identifier: strike_hammer */
  int action;       /**< CONTACTSPLINE_STRIKE, CONTACTSPLINE_PLUCK or CONTACTSPLINE_BOW */
  size_t number;    /**< among the events of its action */
  size_t parameter; /**< index of the parameter that holds its usual value */
} contactspline_event;

/** Version of the library: "0.2.0". */
const char* contactspline_version(void);

/** Why the last function of this thread that failed did so, as one line: file, key, what is wrong, what is allowed.
 * Empty before the first failure; stays until the next one. */
const char* contactspline_last_error(void);

/** Names of the instruments that ship; ends with a null pointer. */
const char* const* contactspline_names(void);

/** An instrument at rest, by its name or by the path of an instrument file. Rate: 1000 to 768000 Hz.
 * Returns null where it fails. Allocates. */
contactspline_instrument* contactspline_create(const char* name, double sample_rate_hz, int precision);

/** The same from the text of an instrument file (docs/reference/instruments.md), which ends with a 0. `file` stands
 * in messages; files that the text names are read from its folder. */
contactspline_instrument* contactspline_create_from_json(const char* text, const char* file, double sample_rate_hz,
                                                         int precision);

/** Lets `other`, a new instrument of the same rate and precision, take the place of an instrument at its next event or
 * block, also while another thread plays it: what it rings fades out within 10 ms, and parameters that have been set
 * keep their values. Its lists stay; what both have by the same name is played. Ends `other`. Returns 1; 0 where it
 * fails, and all is as before. Allocates; one thread at a time. */
int contactspline_replace(contactspline_instrument* instrument, contactspline_instrument* other);

/** Replaces an instrument in the same way by one that runs at 1, 2, 4 or 8 times its rate, for contacts that are too
 * short for it. Returns 1; 0 where it fails. */
int contactspline_oversample(contactspline_instrument* instrument, int factor);

/** How late its outputs and its force are, because it is oversampled [samples]: 0, 34, 37 or 38. */
size_t contactspline_latency(const contactspline_instrument* instrument);

/** Ends an instrument; a null pointer does nothing. */
void contactspline_destroy(contactspline_instrument* instrument);

/** Identifier, one line, and SPDX identifier of its licence; null for a null instrument. */
const char* contactspline_name(const contactspline_instrument* instrument);
const char* contactspline_description(const contactspline_instrument* instrument);
const char* contactspline_license(const contactspline_instrument* instrument);

/** Lists. Safe for audio. An index that is too large gives a null pointer. */
size_t contactspline_parameter_count(const contactspline_instrument* instrument);
const contactspline_parameter* contactspline_parameter_at(const contactspline_instrument* instrument, size_t index);
size_t contactspline_output_count(const contactspline_instrument* instrument);
const contactspline_output* contactspline_output_at(const contactspline_instrument* instrument, size_t index);
size_t contactspline_event_count(const contactspline_instrument* instrument);
const contactspline_event* contactspline_event_at(const contactspline_instrument* instrument, size_t index);
size_t contactspline_preset_count(const contactspline_instrument* instrument);
const char* contactspline_preset_name(const contactspline_instrument* instrument, size_t index);

/** Parameters. Safe for audio. The value of an index that is too large is not a number. */
void contactspline_set(contactspline_instrument* instrument, size_t parameter, double value);
double contactspline_get(const contactspline_instrument* instrument, size_t parameter);
void contactspline_load_preset(contactspline_instrument* instrument, size_t preset);

/** A key of MIDI goes down, with a velocity from 0 to 1, and up. Safe for audio. Keys that it lacks do nothing. */
void contactspline_note_on(contactspline_instrument* instrument, int key, double velocity);
void contactspline_note_off(contactspline_instrument* instrument, int key);

/** Cents of the 128 keys of MIDI above equal temperament with A4 = 440 Hz, from the texts of a scale and a key map of
 * Scala (.scl and .kbm), each of which may be null, and the pitch of A4 [Hz]; 0: that of the key map, or 440. A key that
 * does not sound is not a number. Returns 1; 0 where it fails. Allocates. */
int contactspline_read_tuning(const char* scale, const char* keymap, double a4_hz, double* cents);

/** Tunes the keys by such a table, null for equal temperament, for the notes that begin from now on. A key that is tuned
 * by more than a tone is played by the strings nearest to its pitch. Safe for audio. Returns 1; 0 for an instrument
 * without keys that have a pitch. */
int contactspline_tune(contactspline_instrument* instrument, const double* cents);

/** Events by their number among those of their action. Safe for audio. Speed in m/s; 0 lifts the damper without a
 * blow, which release lowers. Force in N, reached within rise_s. */
void contactspline_strike(contactspline_instrument* instrument, size_t number, double speed_m_per_s);
void contactspline_release(contactspline_instrument* instrument, size_t number);
void contactspline_pluck(contactspline_instrument* instrument, size_t number, double force_n, double rise_s);

/** Advances `samples` samples. outputs: one array for each output of the list, null for those that nobody wants, or
 * null for all; force: the sum of the contact forces [N], or null. Safe for audio. */
void contactspline_process(contactspline_instrument* instrument, float* const* outputs, float* force, size_t samples);
void contactspline_process_double(contactspline_instrument* instrument, double* const* outputs, double* force,
                                  size_t samples);

/** Does what an event says before the next sample; its own sample does not matter. The six functions above are this
 * one. Safe for audio. A number that the instrument lacks does nothing. */
void contactspline_play(contactspline_instrument* instrument, const contactspline_timed_event* event);

/** The same as contactspline_process() with `count` events at their samples, in order of time; those behind the last
 * sample happen behind it. Safe for audio. */
void contactspline_process_events(contactspline_instrument* instrument, const contactspline_timed_event* events,
                                  size_t count, float* const* outputs, float* force, size_t samples);
void contactspline_process_events_double(contactspline_instrument* instrument,
                                         const contactspline_timed_event* events, size_t count,
                                         double* const* outputs, double* force, size_t samples);

/** The same with an input: a force on the body over each sample [N], or null; an instrument without an input ignores
 * it. It may be one of the outputs. */
void contactspline_process_input(contactspline_instrument* instrument, const contactspline_timed_event* events,
                                 size_t count, const float* input, float* const* outputs, float* force,
                                 size_t samples);
void contactspline_process_input_double(contactspline_instrument* instrument, const contactspline_timed_event* events,
                                        size_t count, const double* input, double* const* outputs, double* force,
                                        size_t samples);

/** The force that hosts play as 1 [N]; 0: it has no input. Safe for audio. */
double contactspline_input_scale(const contactspline_instrument* instrument);

/** Brings it to rest; parameters stay. Safe for audio. */
void contactspline_reset(contactspline_instrument* instrument);

/** Energy that is stored [J], and whether nothing moves on its own and the energy is below a limit; whether all that
 * moves rests, be it under a load, with a kinetic energy below a limit. Safe for audio. */
double contactspline_energy(const contactspline_instrument* instrument);
int contactspline_is_silent(const contactspline_instrument* instrument, double limit_j);
int contactspline_is_at_rest(const contactspline_instrument* instrument, double limit_j);

/** Energies [J] of the last sample, and what has happened. What an instrument does not count is 0. */
typedef struct contactspline_books {
  double stored_j;
  double string_j;       /**< the same without a hammer that flies */
  double work_j, heat_j; /**< work of hands and controls, and losses, over the last sample, of instruments of files */
  size_t contacts;       /**< that have begun, of a keyboard */
  size_t failures;       /**< how often a keyboard came to rest because it was not finite */
} contactspline_books;

/** The books of energy; all 0 for a null instrument. Safe for audio. */
contactspline_books contactspline_books_of(const contactspline_instrument* instrument);

/** Whether a key of MIDI plays. Safe for audio. */
int contactspline_has_key(const contactspline_instrument* instrument, int key);

#ifdef __cplusplus
}
#endif

#endif
