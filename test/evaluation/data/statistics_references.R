# Reference values for signed_rank_test.cc, proportion_test.cc, holm and bootstrap_test.cc, from
# R's own stats package and from the package boot (Debian: r-base-core, r-cran-boot). Written once,
# by R 4.2.2 and boot 1.3-28.1:
#   Rscript statistics_references.R
library(boot)
set.seed(20261126)

shortest <- function(x) sapply(x, function(v) format(v, digits = 15, trim = TRUE))
listed <- function(x) paste(shortest(x), collapse = " ")
header <- function(...) c(paste("#", R.version.string, "- boot", as.character(packageVersion("boot"))), ...)

# Hollander and Wolfe (1973), pages 29 to 33: depression of nine patients before and after a
# tranquilizer, as in R's ?wilcox.test.
before <- c(1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30)
after <- c(0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29)
cases <- list(hollander_wolfe = round(before - after, 3),
              sleep = with(sleep, extra[group == 2] - extra[group == 1]),
              heavy_12 = signif(rt(12, 3) + 0.5, 6), heavy_30 = signif(rt(30, 3) + 0.3, 6),
              heavy_49 = signif(rt(49, 3) - 0.2, 6), heavy_80 = signif(rt(80, 3) + 0.15, 6),
              ties_25 = round(rt(25, 3) * 2 + 1), ties_70 = round(rt(70, 3) * 2 + 0.4))
rows <- header("# stats::wilcox.test, correct = TRUE; exact where R has it (no ties or zeros, n < 50)",
               "# estimate: its pseudomedian, where exact",
               "#name,exact,v,p_value,estimate,differences")
for (name in names(cases)) {
  d <- cases[[name]]
  plain <- !any(d == 0) && !any(duplicated(abs(d)))
  if (plain && length(d) < 50) {
    t <- wilcox.test(d, exact = TRUE, conf.int = TRUE)
    rows <- c(rows, paste(name, 1, shortest(t$statistic), shortest(t$p.value),
                          shortest(t$estimate), listed(d), sep = ","))
  }
  t <- suppressWarnings(wilcox.test(d, exact = FALSE, correct = TRUE))
  rows <- c(rows, paste(name, 0, shortest(t$statistic), shortest(t$p.value), "", listed(d), sep = ","))
}
writeLines(rows, "signed_rank_r.csv")

rows <- header("# stats::prop.test(correct = FALSE) is Wilson's interval, stats::binom.test Clopper and Pearson's",
               "#events,trials,confidence,wilson_low,wilson_high,exact_low,exact_high")
for (trial in list(c(0, 20), c(1, 20), c(3, 7), c(20, 20), c(17, 60), c(499, 500))) {
  for (confidence in c(0.95, 0.9)) {
    wilson <- suppressWarnings(prop.test(trial[1], trial[2], correct = FALSE, conf.level = confidence))$conf.int
    exact <- binom.test(trial[1], trial[2], conf.level = confidence)$conf.int
    rows <- c(rows, paste(trial[1], trial[2], confidence, shortest(wilson[1]), shortest(wilson[2]),
                          shortest(exact[1]), shortest(exact[2]), sep = ","))
  }
}
writeLines(rows, "proportions_r.csv")

rows <- header("# stats::binom.test(first, first + second), two-sided: the exact form of McNemar's test",
               "#only_first,only_second,p_value")
for (pair in list(c(0, 5), c(0, 6), c(1, 8), c(12, 3), c(7, 7), c(40, 61))) {
  rows <- c(rows, paste(pair[1], pair[2], shortest(binom.test(pair[1], sum(pair))$p.value), sep = ","))
}
writeLines(rows, "mcnemar_r.csv")

rows <- header("# stats::p.adjust(method = \"holm\")", "#number,p_values,adjusted")
sets <- list(c(0.01, 0.04, 0.03, 0.005), c(0.2, 0.001, 0.001, 0.9, 0.05), c(0.049), signif(runif(12)^3, 6))
for (i in seq_along(sets)) {
  rows <- c(rows, paste(i, listed(sets[[i]]), listed(p.adjust(sets[[i]], "holm")), sep = ","))
}
writeLines(rows, "holm_r.csv")

# The acceleration from leaving out one value at a time; so many resamples that the ends are known
# to a hundredth of the interval's length.
hodges_lehmann <- function(x) {
  means <- outer(x, x, "+") / 2
  median(means[lower.tri(means, diag = TRUE)])
}
rows <- header("# boot::boot with 100000 resamples, boot::boot.ci(type = \"bca\") with empinf(type = \"jack\")",
               "#name,statistic,confidence,estimate,low,high,values")
for (name in c("sleep", "heavy_12", "heavy_30")) {
  for (statistic in c("mean", "hodges_lehmann")) {
    # Of rounded values many resamples equal the estimate; boot counts none of them as below it, Duet
    # half of them.
    if (name == "sleep" && statistic == "hodges_lehmann") next
    d <- cases[[name]]
    of <- function(x, i) if (statistic == "mean") mean(x[i]) else hodges_lehmann(x[i])
    samples <- boot(d, of, R = 100000)
    ci <- boot.ci(samples, conf = c(0.9, 0.95), type = "bca", L = empinf(data = d, statistic = of, type = "jack", stype = "i"))
    for (k in 1:2) {
      rows <- c(rows, paste(name, statistic, ci$bca[k, 1], shortest(samples$t0), shortest(ci$bca[k, 4]),
                            shortest(ci$bca[k, 5]), listed(d), sep = ","))
    }
  }
}
writeLines(rows, "bootstrap_r.csv")
