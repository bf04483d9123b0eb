// Reports in a real browser: what they show, by pointer and by keyboard, and how fast.
// ARCLEN names the program; BROWSER the browser's.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";
import { after, before, test } from "node:test";
import { chromium } from "playwright-core";

const { ARCLEN, BROWSER } = process.env;
const FRAME = 16;
const CASES = fileURLToPath(new URL("../../cases/", import.meta.url));
let folder;
let browser;

/** Writes a report; its path. */
const report = (name, ...words) => {
  const out = join(folder, name);
  execFileSync(ARCLEN, [...words, "--report", "--quiet", "--no-pictures", "--out", out]);
  return join(out, "report.html");
};
const pages = {};

before(async () => {
  folder = mkdtempSync(join(tmpdir(), "arclen-report-"));
  pages.contact = report("contact", "trace", "fig12", "--elements", "100");
  pages.diagram = report("diagram", "diagram", "enz");
  pages.long = report("long", "trace", "fig06", "--elements", "100", "--set", "path.max_step=0.00128");
  pages.cycle = report("cycle", "cycle", "fig16", "--elements", "80", "--set", "path.start=1.2", "--set", "path.end=0.9");
  pages.physical = report("physical", "trace", "polymer", "--elements", "80", "--set", "path.end=1.0");
  pages.ring = report("ring", "trace", CASES + "ring-load.toml", "--elements", "80", "--set", "path.end=12");
  browser = await chromium.launch({ executablePath: BROWSER, args: ["--no-sandbox"] });
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

/** Runs with a page, and asserts that neither it nor its console complained, nor asked the network. */
const visit = async (which, options, run) => {
  const page = await browser.newPage(options);
  const complaints = [];
  page.on("console", (message) => complaints.push(`${message.type()}: ${message.text()}`));
  page.on("pageerror", (error) => complaints.push(String(error)));
  const url = pathToFileURL(pages[which]).href;
  page.on("request", (request) => {
    if (request.url().split("#")[0] !== url && !request.url().startsWith("data:")) complaints.push(request.url());
  });
  await page.goto(url);
  await run(page);
  await frames(page);
  assert.deepEqual(complaints, []);
  await page.close();
};

/** Waits until what was asked for is drawn. */
const frames = (page) => page.evaluate(() => new Promise((done) => {
  requestAnimationFrame(() => requestAnimationFrame(done));
}));
const value = async (page, name) => {
  const at = page.locator("#state div", { has: page.locator(`dt:text-is("${name}")`) });
  return (await at.locator("dd").textContent()).replace("−", "-");
};
/** What a chart's canvas shows. */
const pixels = (page, title) =>
  page.locator(`figure[aria-label="${title}"] canvas`).evaluate((canvas) => canvas.toDataURL());
const data = (page) => page.evaluate(() => JSON.parse(document.getElementById("data").textContent));

test("arrow keys move along the curve, and the state follows", async () => {
  await visit("contact", { viewport: { width: 1280, height: 900 } }, async (page) => {
    const { curves: [curve] } = await data(page);
    const shape = await pixels(page, "Shape");
    const pressure = await pixels(page, "Pressure of the film");
    await page.keyboard.press("Tab");
    assert.equal(await page.evaluate(() => document.activeElement.id), "curve-0");
    for (let i = 0; i < 40; i += 1) await page.keyboard.press("ArrowRight");
    await frames(page);
    assert.equal(await value(page, "curve"), `branch, point 41 of ${curve.unstable.length}`);
    assert.equal(Number(await value(page, "z0")), Number(curve.columns.z0[40].toPrecision(6)));
    assert.equal(Number(await value(page, "force")), Number(curve.columns.force[40].toPrecision(6)));
    assert.notEqual(await pixels(page, "Shape"), shape);
    assert.notEqual(await pixels(page, "Pressure of the film"), pressure);
    const said = await page.locator("#curve-0").getAttribute("aria-valuetext");
    assert.match(said, /^point 41 of \d+, deformation .*, z0 .*, force .*, stable/);
    // the same keys serve where no slider has the focus
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press("ArrowLeft");
    await frames(page);
    assert.match(await value(page, "curve"), /point 40 of/);
    await page.locator("#curve-0").focus();
    await page.keyboard.press("End");
    await frames(page);
    assert.equal(Number(await value(page, "z0")), 0.65);
  });
});

test("a case in physical units is shown in those too, at the same point", async () => {
  await visit("physical", { viewport: { width: 1280, height: 900 } }, async (page) => {
    assert.match(await page.locator("#about").textContent(), /Hooke's law.*R₀ = 1\.5 µm.*w₀ = 10−4 N\/m/u);
    for (let i = 0; i < 6; i += 1) {
      await page.keyboard.press("ArrowRight");
      await frames(page);
    }
    const place = await value(page, "curve");
    assert.match(place, /point 7 of/);
    const z0 = Number(await value(page, "z0"));
    await page.getByRole("button", { name: "physical units" }).click();
    await page.locator('#units button[value="physical"][aria-pressed="true"]').waitFor();
    await frames(page);
    assert.equal(await value(page, "curve"), place);
    assert.ok(Math.abs(Number(await value(page, "z0 [nm]")) / (1500 * z0) - 1) < 1e-5);
    const axes = await page.locator("figure canvas").evaluateAll((all) => all.map((one) => one.getAttribute("aria-label")));
    assert.ok(axes.some((label) => /force F \[[pn]N\] over plate distance z₀ \[nm\]$/u.test(label)), axes.join("\n"));
    assert.ok(axes.some((label) => /^Shape: height z \[nm\]/u.test(label)), axes.join("\n"));
    assert.match(await page.locator("#events th").allTextContents().then((all) => all.join()), /z0 \[nm\].*force \[[pn]N\]/u);
    await page.getByRole("button", { name: "dimensionless" }).click();
    await page.locator('#units button[value="dimensionless"][aria-pressed="true"]').waitFor();
    assert.equal(Number(await value(page, "z0")), z0);
  });
  await visit("contact", { viewport: { width: 1280, height: 900 } }, async (page) => {
    assert.equal(await page.locator("#units").isVisible(), false);
  });
});

test("pointer, click and the table of special points choose a point", async () => {
  await visit("contact", { viewport: { width: 1280, height: 900 } }, async (page) => {
    const { curves: [curve] } = await data(page);
    const over = page.locator('figure[aria-label="Force against deformation"] .u-over');
    const box = await over.boundingBox();
    await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
    await frames(page);
    const hovered = await value(page, "curve");
    assert.doesNotMatch(hovered, /point 1 of/);
    await page.mouse.click(box.x + box.width - 3, box.y + 3);
    await frames(page);
    assert.notEqual(await value(page, "curve"), hovered);
    const folds = curve.marks.filter((mark) => mark.kind === "fold");
    assert.equal(folds.length, 2);
    await page.getByRole("button", { name: "fold", exact: true }).nth(1).click();
    await frames(page);
    assert.equal(await value(page, "special point"), "fold");
    assert.match(await value(page, "curve"), new RegExp(`point ${folds[1].point + 1} of`));
    // the marker stands where the curve is
    const whole = await pixels(page, "Force against deformation");
    await page.getByRole("button", { name: "zoom in on the selected point: Force against deformation" }).click();
    await frames(page);
    assert.notEqual(await pixels(page, "Force against deformation"), whole);
    const [here, frame] = [await over.locator(".here").boundingBox(), await over.boundingBox()];
    assert.ok(Math.abs(here.x + here.width / 2 - frame.x - frame.width / 2) < 2);
    assert.ok(Math.abs(here.y + here.height / 2 - frame.y - frame.height / 2) < 2);
    await page.getByRole("button", { name: "show all: Force against deformation" }).click();
    await frames(page);
    assert.equal(await pixels(page, "Force against deformation"), whole);
  });
});

test("tab goes from curve to curve of a diagram, which has no shapes", async () => {
  await visit("diagram", { viewport: { width: 1280, height: 900 } }, async (page) => {
    assert.equal(await page.locator('figure[aria-label="Shape"]').count(), 0);
    await page.keyboard.press("Tab");
    await page.keyboard.press("Tab");
    await page.keyboard.press("ArrowRight");
    await frames(page);
    assert.match(await value(page, "curve"), /^branch 1, point 2 of/);
    await page.keyboard.press("Shift+Tab");
    await frames(page);
    assert.match(await value(page, "curve"), /^first branch, point 1 of/);
  });
});

test("a cycle jumps on both of its ways", async () => {
  await visit("cycle", { viewport: { width: 1280, height: 900 } }, async (page) => {
    const { curves } = await data(page);
    assert.match(await value(page, "curve"), /^approach, point 1 of/);
    const { jumps: [after] } = curves[2];
    await page.getByRole("button", { name: "jump", exact: true }).nth(1).click();
    await frames(page);
    assert.match(await value(page, "curve"), new RegExp(`^retract, point ${after + 1} of`));
    const shape = await pixels(page, "Shape");
    await page.locator("#curve-2").focus();
    await page.keyboard.press("ArrowLeft");
    await frames(page);
    // the plates of a grip stand still
    assert.equal(Number(await value(page, "z0")), Number(curves[2].columns.z0[after].toPrecision(6)));
    assert.equal(Number(await value(page, "force")), Number(curves[2].columns.force[after - 1].toPrecision(6)));
    assert.notEqual(await pixels(page, "Shape"), shape);
    // where the ways run together the pointer stays on the one that is selected
    const box = await page.locator('figure[aria-label="Force against plate distance"] .u-over').boundingBox();
    const { z0, force } = curves[2].columns;
    const at = (values, value) => (value - Math.min(...values)) / (Math.max(...values) - Math.min(...values));
    const place = (k) => [
      box.x + (0.04 + 0.92 * at(z0, z0[k])) * box.width,
      box.y + (0.96 - 0.92 * at(force, force[k])) * box.height,
    ];
    for (const k of [2, 6, 10]) {
      await page.mouse.move(...place(k));
      await frames(page);
      assert.match(await value(page, "curve"), /^retract/);
    }
  });
});

test("a ring-loaded shell has rings and no film", async () => {
  await visit("ring", { viewport: { width: 1280, height: 900 } }, async (page) => {
    assert.equal(await page.locator('figure[aria-label="Pressure of the film"]').count(), 0);
    assert.match(await page.locator('figure[aria-label="Shape"] .legend').textContent(), /planes of the rings/);
    const shape = await pixels(page, "Shape");
    await page.locator("#curve-0").focus();
    await page.keyboard.press("End");
    await frames(page);
    assert.equal(Number(await value(page, "alpha")), 12);
    assert.equal(await value(page, "admissible"), "no");
    assert.notEqual(await pixels(page, "Shape"), shape);
  });
});

test("every control has a name, and nothing sticks out, in all widths and schemes", async () => {
  for (const width of [1280, 400]) {
    const backs = [];
    for (const colorScheme of ["light", "dark"]) {
      for (const which of ["contact", "diagram", "cycle", "ring"]) {
        await visit(which, { viewport: { width, height: 800 }, colorScheme }, async (page) => {
          await frames(page);
          const wide = await page.evaluate(() => document.documentElement.scrollWidth);
          assert.ok(wide <= width, `${which}: ${wide} of ${width} pixels`);
          const nameless = await page.evaluate(() => [...document.querySelectorAll("input, button, canvas, section, figure")]
            .filter((one) => !(one.labels?.[0]?.textContent || one.getAttribute("aria-label") || one.textContent.trim()))
            .map((one) => one.outerHTML));
          assert.deepEqual(nameless, []);
          if (which === "contact") backs.push(await page.evaluate(() => getComputedStyle(document.body).backgroundColor));
        });
      }
    }
    assert.equal(new Set(backs).size, 2, "the schemes differ");
  }
});

test("special points have the counts on both sides, and no column is cut on a narrow screen", async () => {
  for (const width of [1280, 400, 320]) {
    for (const which of ["contact", "diagram", "cycle", "ring"]) {
      await visit(which, { viewport: { width, height: 800 } }, async (page) => {
        const rows = await page.locator("#events tbody tr").evaluateAll((all) => all.map((row) => {
          const box = row.closest(".scroll").getBoundingClientRect();
          const cut = [...row.cells].filter((cell) => {
            const at = cell.getBoundingClientRect();
            return at.left < box.left - 1 || at.right > box.right + 1 || cell.scrollWidth > cell.clientWidth + 1;
          });
          return { kind: row.cells[0].textContent, unstable: row.cells[row.cells.length - 1].textContent, cut: cut.length };
        }));
        assert.ok(rows.length > 0 && rows.every((row) => row.cut === 0), `${which} at ${width}: ${JSON.stringify(rows)}`);
        if (which === "contact") {
          const folds = rows.filter((row) => row.kind === "fold").map((row) => row.unstable);
          assert.deepEqual(folds, ["0 → 1", "1 → 0"]);
        }
      });
    }
  }
});

test("a language that is no valid tag leaves the page whole", async () => {
  for (const language of ["en-US@posix", "C", "c", "", "de-DE", "ja-JP"]) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 900 } });
    await context.addInitScript((tag) => {
      Object.defineProperty(Navigator.prototype, "language", { get: () => tag, configurable: true });
    }, language);
    const page = await context.newPage();
    const complaints = [];
    page.on("console", (message) => complaints.push(message.text()));
    page.on("pageerror", (error) => complaints.push(String(error)));
    await page.goto(pathToFileURL(pages.contact).href);
    await frames(page);
    assert.deepEqual(complaints, [], language);
    assert.equal(await page.locator("figure canvas").count() > 3, true, language);
    assert.match(await value(page, "curve"), /point 1 of/, language);
    await context.close();
  }
});

test("the language of the system leaves the page whole", async () => {
  for (const language of ["C", "POSIX", "de_DE.UTF-8", "ja_JP.UTF-8"]) {
    const env = { ...process.env, LANG: language, LC_ALL: language, LANGUAGE: "" };
    const own = await chromium.launch({ executablePath: BROWSER, args: ["--no-sandbox"], env });
    const page = await own.newPage({ viewport: { width: 400, height: 800 } });
    const complaints = [];
    page.on("console", (message) => complaints.push(message.text()));
    page.on("pageerror", (error) => complaints.push(String(error)));
    await page.goto(pathToFileURL(pages.contact).href);
    await frames(page);
    assert.deepEqual(complaints, [], language);
    assert.equal(await page.locator("figure canvas").count() > 3, true, language);
    await own.close();
  }
});

test("the scheme may change while the page is open", async () => {
  await visit("contact", { viewport: { width: 1280, height: 900 }, colorScheme: "light" }, async (page) => {
    const light = await pixels(page, "Shape");
    await page.emulateMedia({ colorScheme: "dark" });
    await frames(page);
    assert.notEqual(await pixels(page, "Shape"), light);
    await page.setViewportSize({ width: 400, height: 800 });
    await frames(page);
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 400);
  });
});

test("five hundred points are small, and a movement is answered within a frame", async () => {
  const size = statSync(pages.long).size;
  assert.ok(size < 3e6, `${size} bytes`);
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  // the time that the browser spends in scripts of the page, whatever they are called by
  const session = await page.context().newCDPSession(page);
  await session.send("Performance.enable");
  const script = async () => {
    const { metrics } = await session.send("Performance.getMetrics");
    return 1000 * metrics.find((metric) => metric.name === "ScriptDuration").value;
  };
  await page.goto(pathToFileURL(pages.long).href);
  const points = (await data(page)).curves[0].unstable.length;
  assert.ok(points >= 500, `${points} points`);
  const box = await page.locator('figure[aria-label="Force against deformation"] .u-over').boundingBox();
  const seen = new Set();
  const times = [];
  for (let i = 0; i < 60; i += 1) {
    const start = await script();
    await page.mouse.move(box.x + ((i + 1) / 62) * box.width, box.y + (0.9 - 0.6 * (i / 60)) * box.height);
    await frames(page);
    times.push((await script()) - start);
    seen.add(await value(page, "curve"));
  }
  assert.ok(seen.size > 30, `${seen.size} points were shown`);
  times.sort((a, b) => a - b);
  const [middle, most] = [times[times.length >> 1], times[times.length - 1]];
  console.log(`${points} points: ${size} bytes; median ${middle.toFixed(2)} ms, longest ${most.toFixed(2)} ms of script`);
  // on a busy machine one frame may wait for the processor
  const late = times.filter((time) => time > FRAME).length;
  assert.ok(late <= 1, `${late} of ${times.length} took longer than a frame, the longest ${most} ms`);
  await page.close();
});
