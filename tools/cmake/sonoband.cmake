# What every target of the house shares: flags, sanitizers, and one way to make a folder's library.

# Paths relative to the clone, so that a fresh clone elsewhere finds what another has compiled.
find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${CCACHE})
endif()

add_library(sonoband_flags INTERFACE)
target_compile_options(sonoband_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
  # "Same input, same bits": a fused multiply-add rounds once where the reference rounds twice.
  -ffp-contract=off)
target_include_directories(sonoband_flags INTERFACE ${CMAKE_SOURCE_DIR})
if(SONOBAND_WERROR)
  target_compile_options(sonoband_flags INTERFACE -Werror)
endif()
if(SONOBAND_SANITIZE)
  target_compile_options(sonoband_flags INTERFACE -fsanitize=${SONOBAND_SANITIZE} -fno-omit-frame-pointer)
  if(SONOBAND_SANITIZE MATCHES "undefined")
    target_compile_options(sonoband_flags INTERFACE -fno-sanitize-recover=undefined)
  endif()
  target_link_options(sonoband_flags INTERFACE -fsanitize=${SONOBAND_SANITIZE})
endif()
if(SONOBAND_FUZZ)
  target_compile_options(sonoband_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

# sonoband_library(NAME [GLOB...]) makes sonoband::NAME from the .cpp files of this folder and its rooms.
function(sonoband_library name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(FILTER sources EXCLUDE REGEX "/main\\.cpp$")
  add_library(sonoband_${name} STATIC ${sources})
  add_library(sonoband::${name} ALIAS sonoband_${name})
  target_link_libraries(sonoband_${name} PUBLIC sonoband_flags)
endfunction()
