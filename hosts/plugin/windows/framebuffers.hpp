// SPDX-License-Identifier: MIT
// The functions of OpenGL for framebuffers, which programs for Windows find by their names while they run. Where the
// graphics lack them, they do nothing.
#pragma once

#include <OpenGL-include.hpp>

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

namespace contactspline {

template <typename Function, typename... Arguments>
void call_opengl(const char* name, Arguments... arguments) {
  if (const auto function = reinterpret_cast<Function>(reinterpret_cast<void*>(wglGetProcAddress(name))))
    function(arguments...);
}

inline void glGenFramebuffers(GLsizei count, GLuint* frames) {
  call_opengl<PFNGLGENFRAMEBUFFERSPROC>("glGenFramebuffers", count, frames);
}

inline void glBindFramebuffer(GLenum target, GLuint frame) {
  call_opengl<PFNGLBINDFRAMEBUFFERPROC>("glBindFramebuffer", target, frame);
}

inline void glFramebufferTexture2D(GLenum target, GLenum part, GLenum of, GLuint texture, GLint level) {
  call_opengl<PFNGLFRAMEBUFFERTEXTURE2DPROC>("glFramebufferTexture2D", target, part, of, texture, level);
}

inline void glBlitFramebuffer(GLint left, GLint bottom, GLint right, GLint top, GLint to_left, GLint to_bottom,
                              GLint to_right, GLint to_top, GLbitfield what, GLenum filter) {
  call_opengl<PFNGLBLITFRAMEBUFFERPROC>("glBlitFramebuffer", left, bottom, right, top, to_left, to_bottom, to_right,
                                        to_top, what, filter);
}

}  // namespace contactspline
