#include "analysis/latex_symbols.h"

#include <gtest/gtest.h>

namespace npdr::analysis {
namespace {

TEST(LatexSymbols, AreCommandsOfPlainLatex) {
  EXPECT_EQ(latex_symbols("p ≥ 0.1, 3 ± 1, 90°"), "p $\\geq$ 0.1, 3 $\\pm$ 1, 90$^\\circ$");
  EXPECT_EQ(latex_symbols("10⁻³ kg m², log₁₀ θ, Ω"),
            "10$^{-}$$^{3}$ kg m$^{2}$, log$_{1}$$_{0}$ $\\theta$, $\\Omega$");
  EXPECT_EQ(latex_symbols("“a” – ‘b’…"), "``a'' -- `b'\\ldots{}");
}

TEST(LatexSymbols, LettersWithAccentsStay) {
  EXPECT_EQ(latex_symbols("Müller, Ångström, ñ"), "Müller, Ångström, ñ");
}

TEST(LatexSymbols, WhatNoFontHasIsNamed) {
  EXPECT_EQ(latex_symbols("中 \U0001F600 Þ"), "U+4E2D U+1F600 U+00DE");
  EXPECT_EQ(latex_symbols("\uFFFD"), "?");
}

TEST(LatexSymbols, OfUsersAreFormulasAndNothingElse) {
  for (const char* good :
       {"m_p", "\\theta", "\\dot{\\theta}_0", "k_{\\mathrm{m}}", "R_m^2", "D'"}) {
    EXPECT_TRUE(is_latex_symbol(good)) << good;
  }
  for (const char* bad :
       {"", "\\input{/etc/passwd}", "\\write18{ls}", "m$", "a%b", "m_", "\\dot", "{", "}{", "a_b_c",
        "\\thetaX", "#1", "a\nb", "m_p & x", "\\\\", "^^5cinput x", "≥"}) {
    EXPECT_FALSE(is_latex_symbol(bad)) << bad;
  }
  EXPECT_FALSE(is_latex_symbol(std::string(100, 'a')));
}

}  // namespace
}  // namespace npdr::analysis
