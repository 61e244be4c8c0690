// The style sheet of the report.
#pragma once

namespace sweepcast::lab {

/// Colours of series are Okabe and Ito's, which people with colour blindness can tell apart,
/// darkened or lightened for the ground.
inline constexpr const char* kReportStyle = R"css(
:root{color-scheme:light dark;--ground:#fff;--card:#f6f7f9;--ink:#1b2330;--soft:#5b6675;--rule:#d7dce3;
--good:#0a6b4b;--bad:#a8321c;
--c0:#d1006c;--c1:#5b6675;--c2:#0065a8;--c3:#b35900;--c4:#00785a;--c5:#8f4fbf;--c6:#9a7b00;--c7:#2d9bd0;--c8:#6b4a2b;--c9:#7f7f7f}
@media (prefers-color-scheme:dark){:root{--ground:#12161c;--card:#1a2029;--ink:#e6eaf0;--soft:#a0abba;--rule:#343d4a;
--good:#4fd1a1;--bad:#ff8f75;
--c0:#ff5fae;--c1:#b4bdc9;--c2:#5fb4f0;--c3:#f2a65a;--c4:#45cfa5;--c5:#c79bf2;--c6:#e3c54a;--c7:#8fd3f5;--c8:#cfa37a;--c9:#a9a9a9}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:1180px;padding:1.5rem clamp(.9rem,3vw,2rem) 3rem;background:var(--ground);color:var(--ink);
font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Noto Sans",sans-serif;overflow-wrap:anywhere}
h1{font-size:1.7rem;line-height:1.2;margin:0 0 .3rem}
h2{font-size:1.25rem;margin:2.4rem 0 .6rem}
p{margin:.4rem 0 .8rem;max-width:70ch}
.soft,figcaption,caption{color:var(--soft);font-size:.9rem}
.grid{display:grid;gap:1rem;grid-template-columns:repeat(auto-fit,minmax(min(100%,430px),1fr))}
.pictures{display:grid;gap:.8rem;grid-template-columns:repeat(auto-fill,minmax(min(47%,250px),1fr))}
figure{margin:0;background:var(--card);border:1px solid var(--rule);border-radius:.5rem;padding:.8rem;min-width:0}
figure h3{font-size:1rem;margin:0 0 .4rem}
svg.plot{display:block;width:100%;height:auto}
svg.plot text{fill:var(--soft);font-size:13px;font-family:inherit}
.axis{stroke:var(--soft);fill:none}.rule{stroke:var(--rule);fill:none}
.base{stroke:var(--ink);stroke-dasharray:5 4;fill:none}
.line{fill:none;stroke:currentColor;stroke-width:1.6;stroke-linejoin:round}
.strong .line{stroke-width:3}
svg circle,svg path:not([class]){fill:currentColor;stroke:var(--card);stroke-width:.8}
.s0{color:var(--c0)}.s1{color:var(--c1)}.s2{color:var(--c2)}.s3{color:var(--c3)}.s4{color:var(--c4)}
.s5{color:var(--c5)}.s6{color:var(--c6)}.s7{color:var(--c7)}.s8{color:var(--c8)}.s9{color:var(--c9)}
.legend{display:flex;flex-wrap:wrap;gap:.1rem .9rem;margin:.5rem 0 0;padding:0;list-style:none;font-size:.85rem}
.legend svg{width:26px;height:12px;margin-right:.3rem;vertical-align:baseline}
.pictures img{display:block;width:100%;height:auto;aspect-ratio:1}
.wide{overflow-x:auto;max-width:100%}
table{border-collapse:collapse;font-size:.9rem;font-variant-numeric:tabular-nums;overflow-wrap:normal}
th,td{padding:.3rem .7rem;text-align:right;border-bottom:1px solid var(--rule);white-space:nowrap}
th{font-weight:600;color:var(--soft)}
th:first-child,td:first-child,.name{text-align:left}
td small{display:block;color:var(--soft)}
.standing td:first-child{white-space:normal;min-width:9rem;max-width:24rem}
.ahead{color:var(--good)}.behind{color:var(--bad);font-weight:600}
.bar{display:flex;height:1.3rem;border-radius:.25rem;overflow:hidden;background:var(--rule);margin:.15rem 0 .7rem}
.bar span{background:currentColor;border-right:1px solid var(--card);print-color-adjust:exact;-webkit-print-color-adjust:exact}
.swatch{display:inline-block;width:.8rem;height:.8rem;border-radius:.15rem;background:currentColor;margin-right:.35rem;
print-color-adjust:exact;-webkit-print-color-adjust:exact}
@media (max-width:520px){body{font-size:15px}th,td{padding:.3rem .45rem}table{font-size:.82rem}
.grid{gap:.7rem}figure{padding:.55rem}.scroll-hint{display:block}}
@media (min-width:521px){.scroll-hint{display:none}}
@media print{:root{color-scheme:light;--ground:#fff;--card:#fff;--ink:#000;--soft:#444;--rule:#bbb;--good:#0a6b4b;--bad:#a8321c;
--c0:#d1006c;--c1:#5b6675;--c2:#0065a8;--c3:#b35900;--c4:#00785a;--c5:#8f4fbf;--c6:#9a7b00;--c7:#2d9bd0;--c8:#6b4a2b;--c9:#7f7f7f}
body{max-width:none;padding:0;font-size:10pt}.grid{grid-template-columns:1fr 1fr}.pictures{grid-template-columns:repeat(4,1fr)}
figure,tr,.bar-row{break-inside:avoid}h2{break-after:avoid}.wide{overflow:visible}table{font-size:8pt}.scroll-hint{display:none}}
)css";

}  // namespace sweepcast::lab
