# What every target of the project is compiled with.
#   mns_target(TARGET)  C11 without extensions, warnings, sanitizers, hidden symbols, no contraction of a*b+c behind our back

set(MNS_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wconversion)

function(mns_target target)
  set_target_properties(${target} PROPERTIES
    C_STANDARD 11 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF
    C_VISIBILITY_PRESET hidden POSITION_INDEPENDENT_CODE ON)
  if(CMAKE_C_COMPILER_ID MATCHES "GNU|Clang")
    # The program that is built from plain C must not depend on whether the compiler fuses: pictures are compared.
    target_compile_options(${target} PRIVATE ${MNS_WARNINGS} -ffp-contract=off -fno-math-errno)
    if(MNS_WERROR)
      target_compile_options(${target} PRIVATE -Werror)
    endif()
  elseif(MSVC)
    target_compile_options(${target} PRIVATE /W4)
    target_compile_definitions(${target} PRIVATE _CRT_SECURE_NO_WARNINGS)
  endif()
  if(MNS_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${MNS_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
    target_link_options(${target} PRIVATE -fsanitize=${MNS_SANITIZE})
  endif()
endfunction()
