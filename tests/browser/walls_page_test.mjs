// node walls_page_test.mjs PEERD PACKAGES OUT: what the page leaves out because a wall hides it, what that saves, and that the
// picture is the same, on a real peer in a headless Chromium.
//
// PEERD is the program, PACKAGES the folder whose node_modules has playwright-core, OUT where screenshots go. Exit codes: 0
// good, 1 something is wrong, 77 skipped.
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { check, Page, Pixels, testPages, words } from './real_peers.mjs';

const kCracks_px = 3;
const kConfiguration = join(dirname(fileURLToPath(import.meta.url)), 'walls.toml');
const { out } = words();

// So many more pictures, however long they take: what is hidden is known two pictures later, and not all is asked for in each.
function settled(page) {
  return page.tab.evaluate(async () => {
    const begin = window.peerd.pictures;
    while (window.peerd.pictures < begin + 16) {
      document.querySelector('.picture').dispatchEvent(new PointerEvent('pointermove'));
      await new Promise((next) => requestAnimationFrame(next));
    }
  });
}

// A picture with the switch on, once it has settled, and one with it off, of the same view.
async function both(page, viewpoint) {
  await page.viewpoint(viewpoint);
  const one = async (on) => {
    await page.option('occlusion', on);
    await settled(page);
    return { pixels: await Pixels.of(page), drawn: await page.tab.evaluate(() => window.peerd.drawn) };
  };
  const [without, withIt] = [await one(false), await one(true)];
  const differing = await withIt.pixels.differing(without.pixels);
  const { occlusion } = withIt.drawn;
  console.log(`${viewpoint}: ${without.drawn.calls} draw calls and ${without.drawn.triangles} triangles; with what is hidden left out ${withIt.drawn.calls} and ${withIt.drawn.triangles}, for ${occlusion.queries} questions: ${occlusion.leftOut} of ${occlusion.candidates} hidden, ${occlusion.outside} outside`);
  // Between two triangles of the wall a sample may show what is behind, where that is drawn.
  check(differing <= kCracks_px, `${viewpoint}: ${differing} pixels differ`);
  check(without.drawn.occlusion === null, 'the switch is off, and the page asks all the same');
  return { without: without.drawn, withIt: withIt.drawn };
}

// The camera goes to where all can be seen: the second picture after that has everything.
async function nothingStaysMissing(page) {
  await page.viewpoint('In front');
  await settled(page);
  await page.until('the wall hides', () => window.peerd.drawn.occlusion.leftOut > 50);
  const missing = await page.tab.evaluate(async () => {
    const select = document.querySelector('.toolbar select');
    select.value = [...select.options].find(({ label }) => label === 'From above').value;
    select.dispatchEvent(new Event('change', { bubbles: true }));
    const begin = window.peerd.pictures;
    const seen = [];
    while (window.peerd.pictures < begin + 4) {
      await new Promise((next) => requestAnimationFrame(next));
      seen.push([window.peerd.pictures - begin, window.peerd.drawn.occlusion.leftOut]);
    }
    return seen;
  });
  console.log(`left out in the pictures after the camera has jumped: ${missing.map(([picture, count]) => `${picture}: ${count}`).join(', ')}`);
  const late = missing.filter(([picture, count]) => picture >= 3 && count > 32); // the lower rows are below the upper ones
  check(late.length === 0, 'what can be seen is left out for more than a picture');
}

await testPages(kConfiguration, ['a'], async (browser, [address], faults) => {
  const page = await Page.open(browser, 'walls', address, faults);
  await page.until('the world is shown', () => window.peerd.objects().length >= 2 && window.peerd.pictures > 2);
  const front = await both(page, 'In front');
  await page.shot(join(out, 'walls-1280.png'));
  check(front.withIt.triangles < 0.2 * front.without.triangles, 'a wall in front of all saves too little');
  check(front.withIt.calls < 0.2 * front.without.calls, 'a wall in front of all saves too few draw calls');
  check(front.withIt.occlusion.leftOut >= 60, `only ${front.withIt.occlusion.leftOut} are left out behind the wall`);
  await both(page, 'From above');
  await both(page, 'Behind');
  await nothingStaysMissing(page);
});
