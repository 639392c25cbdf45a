# SPDX-License-Identifier: BSD-3-Clause
# Writes r_values.txt: data and what R says of them, an independent oracle of evaluate/statistics.
#   Rscript tests/evaluate/statistics/make_fixtures.R tests/evaluate/statistics/r_values.txt
# Needs Debian's r-cran-coin, r-cran-exactranktests, r-cran-survival and r-cran-boot.
suppressPackageStartupMessages({library(coin); library(exactRankTests); library(survival); library(boot)})
path <- commandArgs(trailingOnly = TRUE)[1]
out <- file(path, "w")
put <- function(name, values) cat(paste(c(name, sprintf("%.15g", values)), collapse = " "), "\n", sep = "", file = out)
cat("# ", R.version.string, "\n", sep = "", file = out)
for (p in c("coin", "exactRankTests", "survival", "boot"))
  cat("# ", p, " ", as.character(packageVersion(p)), "\n", sep = "", file = out)
set.seed(14)

# Two samples of differences first - second: coin's exact test one-sided both ways, and the limits of the
# shift by bisection on coin's one-sided p-values.
upper <- function(x, y) pvalue(oneway_test(c(x, y) ~ factor(rep(c("x", "y"), c(length(x), length(y)))),
                                           distribution = "exact", alternative = "greater"))
lower <- function(x, y) pvalue(oneway_test(c(x, y) ~ factor(rep(c("x", "y"), c(length(x), length(y)))),
                                           distribution = "exact", alternative = "less"))
limit <- function(rejected, from, to) {
  for (i in 1:60) { middle <- (from + to) / 2; if (rejected(middle)) from <- middle else to <- middle }
  (from + to) / 2
}
two <- list(c(6, 5), c(8, 8), c(4, 7))
for (k in seq_along(two)) {
  x <- rnorm(two[[k]][1], 0.3, 0.5); y <- rnorm(two[[k]][2], 0, 0.4)
  if (k == 1) { x <- round(x, 1); y <- round(y, 1) }  # ties
  put(paste0("between.", k, ".x"), x); put(paste0("between.", k, ".y"), y)
  put(paste0("between.", k, ".p"), min(1, 2 * min(upper(x, y), lower(x, y))))
  low <- limit(function(d) upper(x - d, y) <= 0.025, -10, 10)
  high <- limit(function(d) !(lower(x - d, y) <= 0.025), -10, 10)
  put(paste0("between.", k, ".interval"), c(low, high))
}

# Pairs: signs turned. exactRankTests' perm.test is exact for whole numbers; wilcox.exact has ties.
for (k in 1:3) {
  d <- list(c(12, -3, 7, 9, 15, 4, -1, 8), c(5, 5, -5, 2, 8, 3, 9, 1, -2, 6), round(rnorm(12, 4, 10)))[[k]]
  put(paste0("pairs.", k, ".d"), d)
  put(paste0("pairs.", k, ".perm.p"), perm.test(d, paired = FALSE, exact = TRUE)$p.value)
  put(paste0("pairs.", k, ".wilcoxon.p"), wilcox.exact(d, exact = TRUE)$p.value)
  put(paste0("pairs.", k, ".wilcoxon.v"), wilcox.exact(d, exact = TRUE)$statistic)
}
for (n in c(6, 9, 16)) {
  d <- rnorm(n, 0.4, 1)
  w <- wilcox.test(d, conf.int = TRUE, exact = TRUE)
  put(paste0("walsh.", n, ".d"), d); put(paste0("walsh.", n, ".p"), w$p.value)
  put(paste0("walsh.", n, ".estimate"), w$estimate); put(paste0("walsh.", n, ".interval"), w$conf.int)
}

# Holm, Quade.
p <- c(0.01, 0.04, 0.03, 0.005, 0.6)
put("holm.p", p); put("holm.corrected", p.adjust(p, "holm"))
blocks <- matrix(c(5, 4, 7, 10, 12, 1, 3, 1, 0, 2, 16, 12, 22, 22, 35, 5, 4, 3, 5, 4, 10, 9, 7, 13, 10, 19, 18, 28, 37, 58,
                   10, 7, 6, 8, 7), nrow = 7, byrow = TRUE)
for (k in 1:2) {
  m <- if (k == 1) blocks else round(matrix(rnorm(24, rep(c(0, 0.5, 1), each = 8)), nrow = 8), 2)
  q <- quade.test(m)
  put(paste0("quade.", k, ".columns"), ncol(m)); put(paste0("quade.", k, ".values"), as.vector(t(m)))
  put(paste0("quade.", k, ".result"), c(q$statistic, q$parameter, q$p.value))
}

# Times to finish with censoring.
t <- c(6, 6, 6, 6, 7, 9, 10, 10, 11, 13, 16, 17, 19, 20, 22, 23, 25, 32, 32, 34, 35)
e <- c(1, 1, 1, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0)
fit <- survfit(Surv(t, e) ~ 1)
keep <- fit$n.event > 0
put("survival.t", t); put("survival.done", e)
put("survival.times", fit$time[keep]); put("survival.at_risk", fit$n.risk[keep]); put("survival.curve", fit$surv[keep])
for (limit_s in c(15, 30)) {
  put(paste0("survival.mean.", limit_s), survival:::survmean(fit, rmean = limit_s)$matrix["rmean"])
}
put("survival.median", survival:::survmean(fit, rmean = "none")$matrix["median"])

# BCa of the mean of two groups' means, resampled within the groups.
a <- rexp(9); b <- rexp(12) + 0.4
values <- c(a, b); group <- rep(1:2, c(9, 12))
statistic <- function(v, i) { s <- v[i]; g <- group[i]; (mean(s[g == 1]) + mean(s[g == 2])) / 2 }
bs <- boot(values, statistic, R = 200000, strata = group)
put("bca.a", a); put("bca.b", b)
put("bca.interval", boot.ci(bs, type = "bca", L = empinf(bs, type = "reg"))$bca[4:5])
close(out)
